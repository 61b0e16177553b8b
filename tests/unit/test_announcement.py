"""Compilation that takes longer than a second is announced, once."""

from types import SimpleNamespace

import pytest
from numba.core import event

from ehlpetsc.base import compiled
from ehlpetsc.base.compiled import COMPILING, announce_compilation


@pytest.mark.parametrize("seconds, said", [((0.2, 0.3), []), ((0.8, 0.8, 2.0, 0.1), [COMPILING])])
def test_long_compilation_is_announced_once(monkeypatch, seconds, said):
    now, shown, registered = [0.0], [], []
    monkeypatch.setattr(compiled, "clock", SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(event, "register", lambda kind, listener: registered.append(listener))
    announce_compilation(shown.append)
    (listener,) = registered
    for length in seconds:
        for _ in range(2):  # of a function and of one that it calls
            listener.on_start(None)
        now[0] += length
        for _ in range(2):
            listener.on_end(None)
    assert shown == said
