"""Compiled code that is kept belongs to the sources as they are."""

from ehlpetsc.compiled import drop_stale_code


def compiled_code_of(package, name):
    kept = package / "room" / "__pycache__" / f"{name}.f-1.nbi"
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_bytes(b"code")
    return kept


def test_compiled_code_of_changed_imported_and_moved_sources_is_removed(tmp_path):
    package = tmp_path / "package"
    room = package / "room"
    law, other = compiled_code_of(package, "law"), compiled_code_of(package, "other")
    (room / "base.py").write_text("C = 1\n")
    (room / "law.py").write_text("from package.room.base import C\ndef f(): return C\n")
    (room / "other.py").write_text("def f(): return 1\n")
    drop_stale_code(package)
    assert not law.exists() and not other.exists()  # of unknown sources
    law, other = compiled_code_of(package, "law"), compiled_code_of(package, "other")
    drop_stale_code(package)
    assert law.exists() and other.exists()
    (room / "base.py").write_text("C = 25\n")  # imported by law alone
    drop_stale_code(package)
    assert not law.exists() and other.exists()
    (room / "other.py").rename(room / "moved.py")
    drop_stale_code(package)
    assert not other.exists()
