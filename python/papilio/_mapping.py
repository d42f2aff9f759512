"""Results as mappings: ``in``, iteration, ``keys``, ``get``, ``len`` and ``dict()`` in addition to ``[]``."""

from __future__ import annotations

from collections.abc import ItemsView, Iterable, Iterator, KeysView, ValuesView
from typing import Any, Generic, TypeVar, overload

__all__ = ["ByName", "Lookup"]

_Value = TypeVar("_Value")
_Default = TypeVar("_Default")


class Lookup(Generic[_Value]):
    """Values by name. ``in`` and ``get`` accept every name that ``[]`` accepts."""

    __slots__ = ()

    def _names(self) -> Iterable[str]:
        raise NotImplementedError

    def __getitem__(self, name: str) -> _Value:
        raise NotImplementedError

    def keys(self) -> KeysView[str]:
        """Returns the names."""
        return dict.fromkeys(self._names()).keys()

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def __len__(self) -> int:
        return len(self.keys())

    def __bool__(self) -> bool:
        return True

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and self.get(name, _NOTHING) is not _NOTHING

    @overload
    def get(self, name: str) -> _Value | None: ...
    @overload
    def get(self, name: str, default: _Value | _Default) -> _Value | _Default: ...
    def get(self, name: str, default: Any = None) -> Any:
        """Returns the value of a name, or ``default`` if there is none."""
        try:
            return self[name]
        except KeyError:
            return default


class ByName(Lookup[_Value]):
    """A `Lookup` with the views of a dictionary."""

    __slots__ = ()

    def values(self) -> ValuesView[_Value]:
        """Returns the values, in the order of `keys`."""
        return self._read().values()

    def items(self) -> ItemsView[str, _Value]:
        """Returns the names with their values."""
        return self._read().items()

    def _read(self) -> dict[str, _Value]:
        return {name: self[name] for name in self.keys()}


_NOTHING = object()
