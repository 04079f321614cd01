import csv
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow


@pytest.mark.usefixtures("drawn")
@pytest.mark.parametrize(("image", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml")])
def test_a_figure_and_its_curve(cli, folder: Path, image: str, start: bytes):
    result = cli("figures", "new/figs", "--only", "fig09", "--format", image)
    assert result.exit_code == 0
    assert result.stderr.splitlines() == ["wrote new/figs/fig09.csv", f"wrote new/figs/fig09.{image}"]
    assert (folder / f"new/figs/fig09.{image}").read_bytes().startswith(start)
    with (folder / "new/figs/fig09.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert set(rows[0]) == {
        "ceramic thickness, mm",
        "this program: residual over initial mass",
        "total thickness, mm",
        "this program: residual over impact velocity",
    }
    [at_4] = [row for row in rows if row["ceramic thickness, mm"] == "4.0"]
    assert float(at_4["total thickness, mm"]) == 12.0
    assert float(at_4["this program: residual over impact velocity"]) == pytest.approx(1.0 - 0.3471, abs=1e-4)
    assert float(at_4["this program: residual over initial mass"]) == pytest.approx(1.0 - 0.1721, abs=1e-4)


def test_a_parity(cli, folder: Path):
    assert cli("figures", "figs", "--only", "parity_table3", "--format", "svg").exit_code == 0
    with (folder / "figs/parity_table3.csv").open() as file:
        assert len(list(csv.DictReader(file))) == 3 * 13
    assert "agreement" in (folder / "figs/parity_table3.svg").read_text()
