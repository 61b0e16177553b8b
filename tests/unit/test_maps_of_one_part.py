"""Maps of one part: line by line levelling, masks, the difference before and after a test."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from ehlpetsc.base.errors import CaseError, ProfileError
from ehlpetsc.case.checking import values_of
from ehlpetsc.case.loading import load
from ehlpetsc.case.tables.surface import PROFILE
from ehlpetsc.pictures.surface import main
from ehlpetsc.surfaces.samples import areal_samples
from ehlpetsc.surfaces.topography import difference, displacement

STEP = 2e-6
RANDOM = np.random.default_rng(4)
WAVES = 1e-7 * gaussian_filter(RANDOM.standard_normal((200, 240)), 3.0) / 0.09
KEYS, MASKED = ["--set", f"spacing={STEP}"], ["mask=mask.npy"]


def sampled(folder, **keys):
    return areal_samples(folder, values_of(PROFILE, {"file": "map.npy", "spacing": STEP} | keys), 0.0, False)


def test_rows_of_a_scanner_are_levelled_line_by_line(tmp_path):
    lines = RANDOM.normal(0.0, 1e-6, (2, 200, 1))
    waves = 1e-7 * np.cos(2 * np.pi * np.arange(240) / 24) * np.ones((200, 1))
    np.save(tmp_path / "map.npy", waves + lines[0] + lines[1] * np.linspace(-1, 1, 240))
    assert sampled(tmp_path, level=True).sq > 8e-7
    assert sampled(tmp_path, level="rows").sq == pytest.approx(1e-7 / np.sqrt(2), rel=2e-2)


def test_masked_heights_are_missing(tmp_path):
    z, mask = WAVES.copy(), np.zeros(WAVES.shape, bool)
    z[50:54, 20:25] += 5e-6  # dust
    mask[50:54, 20:25] = True
    mask[:, :10] = True  # an edge: cut off
    np.save(tmp_path / "map.npy", z)
    np.save(tmp_path / "mask.npy", mask)
    np.savetxt(tmp_path / "mask.txt", mask)
    for name in ("mask.npy", "mask.txt"):
        found = sampled(tmp_path, mask=name, fill_gaps=12e-6)
        assert found.z.shape == (200, 230)
        assert np.abs(found.z).max() < 1e-6 < np.abs(sampled(tmp_path).z).max()
        other = np.ones_like(mask[:, 10:])
        other[50:54, 10:15] = 0
        np.testing.assert_allclose((found.z - z[:, 10:])[other], found.z[0, 0] - z[0, 10], atol=1e-18)


@pytest.mark.parametrize(
    ("mask", "words", "message"),
    [
        (np.zeros((3, 4)), MASKED, "mask: mask.npy has 3 x 4 values; allowed: as many as heights, 200 x 240"),
        (None, MASKED, "mask: no such file: "),
        (np.eye(200, 240), MASKED, "200 heights missing, the widest gap "),
        (None, ["level=lines"], 'level = "lines": allowed: true or false or "rows" ('),
    ],
)
def test_faulty_masks_and_levels_are_refused_in_one_sentence(tmp_path, capsys, mask, words, message):
    np.save(tmp_path / "map.npy", WAVES)
    if mask is not None:
        np.save(tmp_path / "mask.npy", mask)
    words = [word for key in words for word in ("--set", key)]
    assert main([str(tmp_path / "map.npy"), "--no-picture", *KEYS, *words]) == 2
    printed = capsys.readouterr().err
    assert message in printed and printed.count("\n") == 1


def test_a_mask_is_of_a_map(tmp_path):
    (tmp_path / "p.csv").write_text("".join(f"{1e-6 * k}, {1e-7 * np.sin(k)}\n" for k in range(400)))
    tables = {
        "title": "mask",
        "motion": {"entrainment_speed": 1.0, "slide_roll_ratio": 0.0},
        "contact": {"radius": [0.01, 0.01], "load": 20.0, "youngs_modulus": 207e9, "poisson_ratio": 0.3},
        "mesh": {"inlet": -2.0, "outlet": 1.5, "points_per_half_width": 8, "width": 4.0},
        "surface": {"1": {"file": str(tmp_path / "p.csv"), "mask": "mask.npy"}},
    }
    with pytest.raises(CaseError, match="mask: of a map, not of a profile"):
        load(tables)


def test_the_difference_is_what_was_worn(tmp_path, capsys):
    """The map after the test begins elsewhere, by 5 rows and -22/3 columns."""
    fine = gaussian_filter(RANDOM.standard_normal((220, 750)), (3.0, 9.0))
    fine *= 1e-7 / fine.std()
    before = fine[10:210, 24:744:3]
    after = fine[15:215, 2:722:3].copy()
    after[75:115, 108:137] -= 2e-7
    for name, z in (("before", before), ("after", after)):
        np.save(tmp_path / f"{name}.npy", z)
    words = [str(tmp_path / "before.npy"), "--minus", str(tmp_path / "after.npy"), *KEYS]
    target = tmp_path / "worn.gsf"
    assert main([*words, "--set", "level=false", "-o", str(target)]) == 0
    assert "\nsecond map moved by -14." in capsys.readouterr().out
    moved, correlation = displacement(before, after)
    assert moved == pytest.approx([5.0, -22 / 3], abs=0.05) and correlation > 0.9
    z = np.frombuffer(target.read_bytes()[-4 * 195 * 233 :], "<f4").reshape(195, 233)
    assert z[80:110, 104:125].mean() - z[10:60, 20:220].mean() == pytest.approx(2e-7, rel=1e-2)
    assert z[10:60, 20:220].std() < 2e-9
    assert main(words) == 0  # beside the picture of the first map, not in its place
    assert [file.name for file in tmp_path.glob("*.png")] == ["before.minus.png"]


def test_maps_of_other_places_or_spacings_have_no_difference(tmp_path, capsys):
    np.save(tmp_path / "map.npy", WAVES)
    np.save(tmp_path / "b.npy", 1e-7 * RANDOM.standard_normal((200, 240)))
    assert main([str(tmp_path / "map.npy"), "--minus", str(tmp_path / "b.npy"), "--no-picture", *KEYS]) == 2
    printed = capsys.readouterr().err
    assert "b.npy: correlates with the first map by 0." in printed and printed.count("\n") == 1
    found = sampled(tmp_path)
    with pytest.raises(ProfileError, match="points 4 x 2 um apart; allowed for a difference: 2 x 2 um"):
        difference(found, replace(found, X=2 * found.X))
    ridge = replace(found, Y=found.Y[:1], z=found.z[:1])
    with pytest.raises(ProfileError, match="a profile; allowed for a difference: maps"):
        difference(found, ridge)
