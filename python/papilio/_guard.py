"""A fault of the extension module becomes an exception of papilio: all of its functions, methods and properties pass through here.

A panic of compiled code reaches Python as ``pyo3_runtime.PanicException``, which is no ``Exception``: scripts that catch errors of one
design, and go on with the next one, would end.
"""

from __future__ import annotations

import functools
import types
from collections.abc import Callable
from typing import Any

from .errors import InternalError

#: Module of the exception for a panic, which has no public name.
_PANIC = "pyo3_runtime"


def guarded(call: Callable[..., Any]) -> Callable[..., Any]:
    """The same function, which raises `InternalError` for a panic."""

    @functools.wraps(call)
    def checked(*args: Any, **kwargs: Any) -> Any:
        try:
            return call(*args, **kwargs)
        except BaseException as error:
            if type(error).__module__ != _PANIC:
                raise
            raise InternalError(f"internal error of papilio: {error}") from None

    return checked


def guard_module(module: types.ModuleType) -> None:
    """Guards all functions of a module, and all methods and properties of its classes."""
    for name, value in list(vars(module).items()):
        if isinstance(value, types.BuiltinFunctionType):
            setattr(module, name, guarded(value))
        elif isinstance(value, type) and value.__module__ == module.__name__:
            _guard_class(value)


def _guard_class(of: type) -> None:
    for name, value in list(vars(of).items()):
        # Python cannot replace `__new__`, which is guarded in `python/src/errors.rs`.
        if isinstance(value, types.MethodDescriptorType | types.WrapperDescriptorType):
            setattr(of, name, guarded(value))
        elif isinstance(value, types.GetSetDescriptorType):
            setattr(of, name, property(guarded(value.__get__), doc=value.__doc__))
        elif isinstance(value, types.ClassMethodDescriptorType):
            setattr(of, name, classmethod(guarded(_of_class(value))))
        elif isinstance(value, staticmethod):
            setattr(of, name, staticmethod(guarded(value.__func__)))


def _of_class(method: types.ClassMethodDescriptorType) -> Callable[..., Any]:
    """A method of a class as a function of the class."""

    @functools.wraps(method)
    def call(of: type, *args: Any, **kwargs: Any) -> Any:
        return method.__get__(None, of)(*args, **kwargs)

    return call
