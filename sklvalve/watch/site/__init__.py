# SPDX-License-Identifier: BSD-3-Clause
"""Pages for whoever plans the work: the plant by urgency, a page for each valve; no network, no script."""

from sklvalve.watch.site.write import write_site

__all__ = ["write_site"]
