"""The stubs of the compiled half say what is there."""

import ast
from pathlib import Path

import myoenv
from myoenv import _native


def names(body) -> set[str]:
    """Public functions and classes of a parsed body."""
    kinds = (ast.FunctionDef, ast.ClassDef)
    return {node.name for node in body if isinstance(node, kinds) and not node.name.startswith("_")}


def test_stubs_name_everything_and_nothing_else():
    stub = ast.parse((Path(myoenv.__file__).parent / "_native.pyi").read_text())
    assert names(stub.body) == {name for name in dir(_native) if not name.startswith("_")}
    for node in stub.body:
        if isinstance(node, ast.ClassDef) and not issubclass(getattr(_native, node.name), Exception):
            there = {name for name in vars(getattr(_native, node.name)) if not name.startswith("_")}
            assert names(node.body) == there, node.name


def test_the_package_is_typed_and_exports_what_it_says():
    assert (Path(myoenv.__file__).parent / "py.typed").exists()
    assert all(hasattr(myoenv, name) for name in myoenv.__all__)
