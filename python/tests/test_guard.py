"""A fault of the extension module is an exception of papilio."""

import inspect

import papilio
import pytest
from papilio import _guard, _papilio


class PanicException(BaseException):
    """As that of the extension module, which has no public name."""


PanicException.__module__ = "pyo3_runtime"


def panics():
    """Doc."""
    raise PanicException("index out of bounds")


def test_panic_is_an_error_of_papilio():
    with pytest.raises(papilio.PapilioError, match="internal error of papilio: index out of bounds") as error:
        _guard.guarded(panics)()
    assert isinstance(error.value, papilio.InternalError) and isinstance(error.value, Exception)
    assert _guard.guarded(panics).__doc__ == "Doc."


def test_other_exceptions_stay():
    def interrupted():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        _guard.guarded(interrupted)()


def functions_of(value):
    """The functions behind a method or a property."""
    if isinstance(value, property):
        return [value.fget]
    return [value.__func__] if isinstance(value, staticmethod | classmethod) else [value]


def test_every_call_of_the_extension_module_is_guarded():
    public = {name: value for name, value in vars(_papilio).items() if not name.startswith("__")}
    functions = [value for value in public.values() if callable(value) and not inspect.isclass(value)]
    classes = [value for value in public.values() if inspect.isclass(value)]
    # Python cannot replace `__new__`; the extension module guards it.
    plain = {"__new__", "__module__", "__doc__"}
    methods = [call for one in classes for name, value in vars(one).items() if name not in plain for call in functions_of(value)]
    assert len(functions) > 20 and len(methods) > 60
    assert [call for call in functions + methods if not hasattr(call, "__wrapped__")] == []
