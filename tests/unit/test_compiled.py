"""Compiled code that is kept belongs to the sources as they are."""

import os

from ehlpetsc.compiled import drop_stale_code


def test_compiled_code_of_changed_sources_is_removed(tmp_path):
    source, kept = tmp_path / "room" / "law.py", tmp_path / "room" / "__pycache__" / "law.f-1.nbi"
    kept.parent.mkdir(parents=True)
    source.write_text("def f(): return 1\n")
    kept.write_bytes(b"of an earlier version")
    drop_stale_code(tmp_path)
    assert not kept.exists()
    kept.write_bytes(b"of this version")
    drop_stale_code(tmp_path)
    assert kept.exists()
    os.utime(source, ns=(1, 1))
    drop_stale_code(tmp_path)
    assert not kept.exists()
    kept.write_bytes(b"again")
    source.rename(source.with_name("moved.py"))
    drop_stale_code(tmp_path)
    assert not kept.exists()
