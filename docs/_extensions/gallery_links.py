# SPDX-License-Identifier: BSD-3-Clause
"""A link to the file of an example, good where pages are read as they are, leads to its gallery page."""

import re

from sphinx import addnodes

_EXAMPLE = re.compile(r"(?:\.\./docs/)?examples/(plot_\w+)\.py")


def setup(app):
    # before the files behind links are gathered for download
    app.connect("doctree-read", _to_pages, priority=100)
    return {"parallel_read_safe": True}


def _to_pages(app, doctree):
    for link in list(doctree.findall(addnodes.download_reference)):
        if example := _EXAMPLE.fullmatch(link["reftarget"]):
            to_page = addnodes.pending_xref(
                "",
                *link.children,
                refdomain="std",
                reftype="doc",
                reftarget=f"/auto_examples/{example[1]}",
                refexplicit=True,
                refwarn=True,
                refdoc=app.env.docname,
            )
            link.replace_self(to_page)
