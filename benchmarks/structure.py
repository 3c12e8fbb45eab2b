# SPDX-License-Identifier: BSD-3-Clause
"""How the core that decides is built: lengths, complexity, deciding constants, order of imports, words.

    python -m benchmarks.structure [--words]

One table of what is asked and what is there; `--words` lists the private words that are left, by file.
"""

import argparse
import ast
import re
import statistics
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CORE = ROOT / "sklvalve" / "mismatch"
#: Private words of names, each a whole part of a name between underscores.
WORDS = (
    "rest", "price", "worth", "matters", "strength", "circumstances", "exceeded", "adequacy", "withholding",
    "folded", "spells", "course", "moments", "afresh", "sifting", "going_on", "standing", "given", "foreseen",
    "told", "march", "every_row_alike", "side_by_side", "member", "members", "workbench", "found", "own",
    "who", "less", "more",
)  # fmt: skip
_BRANCHES = (ast.If, ast.For, ast.While, ast.IfExp, ast.ExceptHandler, ast.comprehension, ast.Assert)


def main(arguments=None):
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--words", action="store_true")
    asked = parser.parse_args(arguments)
    trees = {p: ast.parse(p.read_text(encoding="utf-8")) for p in sorted(CORE.rglob("*.py"))}
    if asked.words:
        _print_words(trees)
        return
    functions = [f for tree in trees.values() for f in ast.walk(tree) if _is_function(f)]
    lengths = [_length(f) for f in functions]
    graph = {_module(p): _imports(p, tree) for p, tree in trees.items()}
    rows = [
        ("lines", 8000, sum(len(p.read_text(encoding="utf-8").splitlines()) for p in trees)),
        ("files", "", len(trees)),
        ("median lines of a function's body", 8, statistics.median(lengths)),
        ("functions of more than 40 lines", 0, sum(n > 40 for n in lengths)),
        ("largest complexity", 12, max(map(_complexity, functions))),
        ("functions of a complexity over 12", 0, sum(_complexity(f) > 12 for f in functions)),
        ("named numbers of modules", 40, sum(map(_constants, trees.values()))),
        ("modules in a cycle of imports", 0, len(_in_cycles(graph))),
        ("functions not annotated throughout", 0, sum(not _annotated(f) for f in functions)),
        ("names with a private word", 0, sum(sum(_private(tree).values()) for tree in trees.values())),
    ]
    print("| what | asked | there |\n|---|---|---|")
    for what, limit, there in rows:
        print(f"| {what} | {limit} | {there:g} |")


def _is_function(node):
    return isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)


def _length(function):
    """Lines of a function's body, without its docstring."""
    body = function.body
    if isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant) and len(body) > 1:
        body = body[1:]
    return body[-1].end_lineno - body[0].lineno + 1


def _complexity(function):
    """Ways through a function, after McCabe: one, and one more for each branch and each `and` or `or`."""
    nodes = list(ast.walk(function))
    either = sum(len(n.values) - 1 for n in nodes if isinstance(n, ast.BoolOp))
    return 1 + either + sum(isinstance(n, _BRANCHES) for n in nodes)


def _constants(tree):
    """Numbers that a module gives a name in capitals."""
    many = 0
    for node in tree.body:
        if isinstance(node, ast.Assign):
            names = [n.id for t in node.targets for n in ast.walk(t) if isinstance(n, ast.Name)]
            numbers = [
                n
                for n in ast.walk(node.value)
                if isinstance(n, ast.Constant) and type(n.value) in (int, float)
            ]
            many += len(names) if numbers and all(re.fullmatch(r"_?[A-Z][A-Z0-9_]*", n) for n in names) else 0
    return many


def _annotated(function):
    every = function.args
    args = [*every.posonlyargs, *every.args, *every.kwonlyargs]
    args = [a for a in (*args, every.vararg, every.kwarg) if a and a.arg not in ("self", "cls")]
    return function.returns is not None and all(a.annotation for a in args)


def _module(path):
    name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
    return name.removesuffix(".__init__")


def _imports(path, tree):
    """Modules of the core that one imports, where it stands or later; not those for its annotations alone."""
    unrun = {n for block in ast.walk(tree) if _is_for_types(block) for n in ast.walk(block)}
    imports = [n for n in ast.walk(tree) if isinstance(n, ast.ImportFrom) and n not in unrun]
    modules = {n.module for n in imports if n.module}
    return {m for m in modules if m.startswith("sklvalve.mismatch.")} - {_module(path)}


def _is_for_types(node):
    """Whether a block holds what type checkers read and no program runs."""
    return isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"


def _in_cycles(graph):
    """Modules that reach themselves."""

    def reached(start):
        seen, open_ = set(), [start]
        while open_:
            for other in graph.get(open_.pop(), ()):
                if other not in seen:
                    seen.add(other)
                    open_.append(other)
        return seen

    return [module for module in graph if module in reached(module)]


def _private(tree):
    """Private words among the names that a module gives: functions, classes, arguments, assigned names."""
    names = []
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.append(node.name)
        elif isinstance(node, ast.arg):
            names.append(node.arg)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.append(node.id)
    counts = Counter()
    for name in names:
        plain = "_" + re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower().strip("_") + "_"
        for word in WORDS:
            counts[word] += f"_{word}_" in plain
    return +counts


def _print_words(trees):
    for path, tree in trees.items():
        counts = _private(tree)
        if counts:
            print(f"{path.relative_to(CORE)}: " + ", ".join(f"{w} {n}" for w, n in counts.most_common()))


if __name__ == "__main__":
    main()
