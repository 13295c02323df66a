"""Volumes are read with the dimensions, spacing, orientation and values that their formats give."""

from __future__ import annotations

import gzip
import locale

import numpy as np
import pytest

from scuro.errors import LoadError, SettingsError
from scuro.load import load

pytest.importorskip("SimpleITK")

SAMPLES = {
    # file: dimensions, spacing, range
    "mni152_t1.nii.gz": ((197, 233, 189), (1, 1, 1), (0, 255)),
    "seg3d_mr.nii.gz": ((160, 232, 160), (1, 0.898437, 0.898437), (0, 512)),
    "nucleon.nrrd": ((41, 41, 41), (1, 1, 1), (0, 249)),
    "channels.vti": ((250, 250, 100), (1, 1, 1), (0, 4)),
    "frog_tissues.vti": ((500, 470, 136), (1, 1, 1.5), (0, 29)),
    "hydrogen.vti": ((64, 64, 64), (1, 1, 1), (0, 1)),
    "neghip.slc": ((66, 66, 66), (1, 1, 1), (0, 255)),
    "stent.npz": ((128, 128, 256), (1, 1, 1), (0, 2000)),
    "lidc2_chestct_256x256x133_u8.raw.gz": ((256, 256, 133), (1, 1, 1), (0, 255)),
    "betaGal.mrc.gz": ((100, 100, 100), (3.54, 3.54, 3.54), (-0.05297, 0.19696)),
    "emd_1155.ccp4.gz": ((141, 91, 281), (16.4, 16.4, 16.4), (-108.5088, 71.43836)),
    "acrolein1gs.cube.gz": ((77, 69, 96), (0.100955,) * 3, (0, 7.34741)),
    "esp.dx.gz": ((57, 52, 26), (0.257037, 0.255102, 0.264782), (-0.08876, 19.5406)),
}


@pytest.mark.parametrize("name", SAMPLES)
def test_samples(shared, name):
    dimensions, spacing, value_range = SAMPLES[name]
    volume = load(shared / "volumes" / name)
    assert volume.values.shape == dimensions[::-1]
    np.testing.assert_allclose(volume.spacing, spacing, rtol=1e-4)
    np.testing.assert_allclose(volume.value_range, value_range, atol=1e-4)
    assert volume.labels == (name in ("channels.vti", "frog_tissues.vti"))


def test_crystal_map_lies_where_gemmi_puts_it(shared):
    """Axes in file order 2, 1, 3 and a start that is not zero, against an independent reader."""
    import gemmi

    path = shared / "volumes" / "3nzd_2fofc.ccp4.gz"
    volume = load(path)
    truth = gemmi.read_ccp4_map(str(path))
    truth.setup(0.0, gemmi.MapSetup.ReorderOnly)
    np.testing.assert_allclose(
        volume.values, np.asarray(truth.grid.array).transpose(2, 1, 0), rtol=1e-6
    )
    start = [truth.header_i32(5 + truth_axis) for truth_axis in (0, 1, 2)]
    fraction = np.array(start) / [truth.header_i32(8 + i) for i in range(3)]
    first = truth.grid.unit_cell.orthogonalize(gemmi.Fractional(*fraction)).tolist()
    np.testing.assert_allclose(volume.world_from_index[:3, 3], first, atol=1e-3)


def test_oblique_nifti_keeps_its_orientation(tmp_path):
    import SimpleITK as sitk

    image = sitk.GetImageFromArray(np.arange(24, dtype=np.int16).reshape(2, 3, 4))
    angle = np.radians(30)
    c, s = np.cos(angle), np.sin(angle)
    image.SetDirection([c, -s, 0, s, c, 0, 0, 0, 1])
    image.SetSpacing([0.5, 2.0, 3.0])
    image.SetOrigin([10.0, 20.0, 30.0])
    sitk.WriteImage(image, str(tmp_path / "oblique.nii.gz"))
    volume = load(tmp_path / "oblique.nii.gz")
    np.testing.assert_allclose(volume.spacing, [0.5, 2, 3], rtol=1e-5)
    # ITK's world is left-posterior-superior, ours right-anterior-superior
    lps = np.array(image.TransformContinuousIndexToPhysicalPoint((3, 2, 1)))
    ours = volume.world_from_index @ [3, 2, 1, 1]
    np.testing.assert_allclose(ours[:3], lps * [-1, -1, 1], atol=1e-4)
    assert volume.anatomical and volume.values[1, 2, 3] == 23


def test_time_and_channel_are_chosen(tmp_path):
    import SimpleITK as sitk
    import tifffile

    data = np.arange(2 * 3 * 4 * 5, dtype=np.uint8).reshape(2, 3, 4, 5)
    steps = [sitk.GetImageFromArray(step) for step in data]
    sitk.WriteImage(sitk.JoinSeries(steps), str(tmp_path / "series.nii"))
    np.testing.assert_array_equal(load(tmp_path / "series.nii", voxels__time=1).values, data[1])
    with pytest.raises(LoadError, match="no time step 2"):
        load(tmp_path / "series.nii", voxels__time=2)
    tifffile.imwrite(
        tmp_path / "channels.tif", data.transpose(1, 0, 2, 3), imagej=True,
        metadata={"axes": "ZCYX", "spacing": 2.5, "unit": "um"}, resolution=(2, 4),
    )  # fmt: skip
    volume = load(tmp_path / "channels.tif", voxels__channel=1)
    np.testing.assert_array_equal(volume.values, data[1])
    np.testing.assert_allclose(volume.spacing, [0.5, 0.25, 2.5])
    np.save(tmp_path / "steps.npy", data)
    np.testing.assert_array_equal(load(tmp_path / "steps.npy", voxels__time=1).values, data[1])


def test_ome_zarr_takes_the_finest_level_that_fits(tmp_path):
    import zarr

    data = np.random.default_rng(1).integers(0, 4000, (1, 2, 6, 8, 10)).astype(np.uint16)
    group = zarr.open_group(str(tmp_path / "image.zarr"), mode="w", zarr_format=2)
    group.create_array("0", data=data)
    group.create_array("1", data=data[..., ::2, ::2, ::2])
    axes = [{"name": n} for n in "tczyx"]
    for axis in axes[2:]:
        axis["unit"] = "micrometer"
    datasets = [
        {"path": str(k), "coordinateTransformations": [
            {"type": "scale", "scale": [1, 1, 3 * 2**k, 0.5 * 2**k, 0.5 * 2**k]}]}
        for k in range(2)
    ]  # fmt: skip
    group.attrs["multiscales"] = [{"version": "0.4", "axes": axes, "datasets": datasets}]
    full = load(tmp_path / "image.zarr", voxels__channel=1)
    np.testing.assert_array_equal(full.values, data[0, 1])
    np.testing.assert_allclose(full.spacing, [0.5, 0.5, 3])
    assert full.unit == "µm"
    half = load(tmp_path / "image.zarr", voxels__limit=100)
    assert half.values.shape == (3, 4, 5) and "level 1" in half.notes[0]


def test_large_volumes_are_averaged_in_blocks(tmp_path):
    data = np.random.default_rng(2).random((7, 8, 10)).astype(np.float32)
    np.save(tmp_path / "large.npy", data)
    volume = load(tmp_path / "large.npy", voxels__limit=100, voxels__spacing=(1, 1, 2))
    fz, fy, fx = (-(-n // m) for n, m in zip(data.shape, volume.values.shape, strict=True))
    assert volume.values.size <= 100 and "more than the limit" in volume.notes[0]
    np.testing.assert_allclose(volume.values[0, 0, 0], data[:fz, :fy, :fx].mean(), rtol=1e-5)
    # a block's centre is where its voxels' centres have their mean
    expected = [(fx - 1) / 2, (fy - 1) / 2, fz - 1.0]
    np.testing.assert_allclose(volume.world_from_index[:3, 3], expected)


def test_dicom_folder_lists_its_series(tmp_path):
    import SimpleITK as sitk

    writer = sitk.ImageFileWriter()
    writer.KeepOriginalImageUIDOn()
    for series, slices in (("1.2.3", 2), ("1.2.4", 3)):
        for k in range(slices):
            image = sitk.GetImageFromArray(np.full((1, 4, 5), k, np.int16))
            image.SetSpacing([0.5, 0.5, 2.0])
            image.SetOrigin([0, 0, 2.0 * k])
            tags = {
                "0020|000e": series, "0020|000d": "1.2", "0008|0018": f"{series}.{k}",
                "0008|0060": "CT", "0008|103e": f"series {series}", "0020|0013": str(k),
                "0020|0032": f"0\\0\\{2 * k}", "0020|0037": "1\\0\\0\\0\\1\\0",
            }  # fmt: skip
            for tag, value in tags.items():
                image.SetMetaData(tag, value)
            writer.SetFileName(str(tmp_path / f"{series}.{k}.dcm"))
            writer.Execute(image)
    locale.setlocale(locale.LC_ALL, "")  # the writer leaves it at C
    with pytest.raises(LoadError, match=r"1\.2\.3 \(CT series 1\.2\.3 2 slices\)"):
        load(tmp_path)
    volume = load(tmp_path, voxels__series="1.2.4")
    assert volume.values.shape == (3, 4, 5)
    np.testing.assert_array_equal(volume.values[:, 0, 0], [0, 1, 2])
    np.testing.assert_allclose(volume.spacing, [0.5, 0.5, 2])


def test_missing_values_are_counted_and_empty(tmp_path):
    data = np.ones((3, 4, 5), np.float64)
    data[0, 0, :2] = np.nan, np.inf
    data[1] = -2.0
    np.save(tmp_path / "holes.npy", data)
    volume = load(tmp_path / "holes.npy")
    assert volume.values.dtype == np.float32 and volume.values[0, 0, 0] == -2
    assert "2 voxels" in volume.notes[0]


DAMAGED = {
    "short.raw": (b"\0" * 7, "has 7 bytes, but 2x2x2 voxels of uint8 need 8"),
    "nothing.nrrd": (b"", "cannot be read"),
    "text.nii": (b"this is no image", "cannot be read"),
    "text.vti": (b"<VTKFile type='ImageData'><ImageData", "VTK cannot read it"),
    "text.npy": (b"\x93NUMPY\x01", "not a readable NumPy file"),
    "text.npz": (b"PK\x03\x04", "not a readable NumPy file"),
    "text.tif": (b"II*\0", "not a readable TIFF"),
    "text.mrc": (b"\0" * 100, "not a readable MRC"),
    "text.cube": (b"title\n\n 1 0 0 0\n", "not a readable Gaussian cube"),
    "text.dx": (b"object 1", "no OpenDX grid"),
    "cut.dx": (
        b"object 1 class gridpositions counts 2 2 2\norigin 0 0 0\ndelta 1 0 0\ndelta 0 1 0\n"
        b"delta 0 0 1\nobject 3 class array items 8 data follows\n1 2 3\n",
        "has 3 values for 8: it is truncated",
    ),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_damaged_files_give_one_sentence(tmp_path, name):
    content, message = DAMAGED[name]
    (tmp_path / name).write_bytes(content)
    options = {"voxels__size": (2, 2, 2), "voxels__type": "u8"} if name == "short.raw" else {}
    with pytest.raises(LoadError, match=message) as caught:
        load(tmp_path / name, **options)
    assert "\n" not in str(caught.value) and name in str(caught.value)


def test_truncated_real_files(shared, tmp_path):
    for name in ("mni152_t1.nii.gz", "betaGal.mrc.gz", "acrolein1gs.cube.gz", "neghip.slc"):
        content = (shared / "volumes" / name).read_bytes()
        (tmp_path / name).write_bytes(content[: len(content) // 2])
        with pytest.raises(LoadError) as caught:
            load(tmp_path / name)
        assert "\n" not in str(caught.value)
    nucleon = (shared / "volumes" / "nucleon.raw").read_bytes()
    (tmp_path / "nucleon.raw").write_bytes(nucleon[:1000])
    (tmp_path / "nucleon.nrrd").write_bytes((shared / "volumes" / "nucleon.nrrd").read_bytes())
    with pytest.raises(LoadError):
        load(tmp_path / "nucleon.nrrd")


def test_wrong_words_give_one_sentence(tmp_path):
    np.savez(tmp_path / "two.npz", a=np.zeros((2, 2, 2)), b=np.ones(3))
    with pytest.raises(LoadError, match="no array 'c': it has a, b"):
        load(tmp_path / "two.npz", voxels__array="c")
    (tmp_path / "data.raw").write_bytes(b"\0" * 8)
    with pytest.raises(LoadError, match="--voxels-size"):
        load(tmp_path / "data.raw")
    with pytest.raises(LoadError, match="unknown type of samples 'u9'"):
        load(tmp_path / "data.raw", voxels__size=(2, 2, 2), voxels__type="u9")
    with pytest.raises(SettingsError, match="three positive numbers"):
        load(tmp_path / "data.raw", voxels__spacing=(1, 0, 1))
    np.save(tmp_path / "complex.npy", np.zeros((2, 2, 2), complex))
    with pytest.raises(LoadError, match="complex"):
        load(tmp_path / "complex.npy")
    with gzip.open(tmp_path / "packed.raw.gz", "wb") as file:
        file.write(b"\1" * 8)
    packed = load(tmp_path / "packed.raw.gz", voxels__size=(2, 2, 2), voxels__type="u8")
    assert packed.values.sum() == 8


def test_zarr_with_unknown_codec(tmp_path):
    import json

    folder = tmp_path / "odd.zarr"
    folder.mkdir()
    meta = {
        "zarr_format": 2, "shape": [4, 4, 4], "chunks": [4, 4, 4], "dtype": "|u1", "fill_value": 0,
        "order": "C", "filters": None, "compressor": {"id": "no-such-codec"},
    }  # fmt: skip
    (folder / ".zarray").write_text(json.dumps(meta))
    with pytest.raises(LoadError, match="cannot be read as Zarr"):
        load(folder)


def test_tomograms_are_smoothed_and_say_so(tmp_path):
    """Dark shells in noise, alone and where they are bright, and as the user wants it."""
    import mrcfile

    rng = np.random.default_rng(4)
    z, y, x = np.indices((48, 48, 48)) - 23.5
    shell = np.abs(np.hypot(np.hypot(x, y), z) - 15) < 1.5
    for sign, told in ((-1, 1), (1, 0)):
        values = (rng.normal(5, 6, shell.shape) + sign * 25 * shell).astype(np.float32)
        with mrcfile.new(tmp_path / "map.mrc", values, overwrite=True):
            pass
        volume = load(tmp_path / "map.mrc")
        assert sum("--voxels-smooth" in note for note in volume.notes) == told
        assert (volume.values[~shell].std() < 4) == bool(told)
        raw, wide = (load(tmp_path / "map.mrc", voxels__smooth=s) for s in (0, 3))
        np.testing.assert_array_equal(raw.values, values)
        assert wide.values.std() < 0.5 * values.std() and wide.notes


def test_crystals_name_their_contour(shared):
    volume = load(shared / "volumes" / "3nzd_2fofc.ccp4.gz")
    assert volume.contour == pytest.approx(1.5 * volume.values.std() + volume.values.mean(), 1e-2)
    assert load(shared / "volumes" / "betaGal.mrc.gz").contour is None
