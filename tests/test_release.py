"""A release: one version everywhere, a page for it, and a script that writes the next one and refuses what is wrong."""

import datetime
import importlib.util
import re
import shutil
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


@pytest.fixture
def release():
    """The script as a module."""
    spec = importlib.util.spec_from_file_location("release", ROOT / ".ci" / "release.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def copied(release, monkeypatch, tmp_path):
    """The script in a folder with the files that it writes."""
    for name in (*release.PLACES, "CHANGELOG.md"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    (tmp_path / "docs" / "releases").mkdir(parents=True)
    monkeypatch.setattr(release, "ROOT", tmp_path)
    return release


def test_one_version_stands_everywhere_and_has_a_page(release) -> None:
    version = release.written()
    assert version == PROJECT["version"]
    assert f'version: "{version}"' in (ROOT / ".ci" / "conda" / "meta.yaml").read_text()
    assert (ROOT / "docs" / "releases" / f"{version}.md").read_text().startswith(f"# Version {version}\n")


def test_the_conda_recipe_needs_what_the_wheel_needs() -> None:
    recipe = (ROOT / ".ci" / "conda" / "meta.yaml").read_text().partition("  run:\n")[2].partition("test:")[0]
    needs = {re.sub(r"-base| ", "", line) for line in re.findall(r"- (.*)", recipe)}
    assert needs == {*PROJECT["dependencies"], f"python{PROJECT['requires-python']}"}


def test_the_next_version_is_written_everywhere_with_its_day(copied) -> None:
    (copied.ROOT / "docs" / "releases" / "9.8.7.md").write_text("# Version 9.8.7\n")
    copied.write("9.8.7", datetime.date(2031, 2, 3))
    assert copied.written() == "9.8.7"
    assert "\nversion: 9.8.7\ndate-released: 2031-02-03\n" in (copied.ROOT / "CITATION.cff").read_text()
    assert "## Unreleased\n\n## 9.8.7, 2031-02-03\n\n- " in (copied.ROOT / "CHANGELOG.md").read_text()
    with pytest.raises(ValueError, match=r"has 9\.8\.7 already"):
        copied.write("9.8.7", datetime.date(2031, 2, 3))


def test_a_release_without_a_page_or_with_two_versions_is_refused(copied) -> None:
    with pytest.raises(ValueError, match=r"9\.8\.7\.md is missing"):
        copied.write("9.8.7", datetime.date(2031, 2, 3))
    with pytest.raises(ValueError, match="'next' is no version"):
        copied.write("next", datetime.date(2031, 2, 3))
    (copied.ROOT / "CITATION.cff").write_text("version: 0.0.1\n")
    with pytest.raises(ValueError, match="versions differ"):
        copied.written()


def test_every_package_that_is_needed_has_its_licence_on_the_page() -> None:
    page = (ROOT / "docs" / "licences.md").read_text()
    extras = [
        need
        for name, needs in PROJECT["optional-dependencies"].items()
        if name not in ("test", "bench")  # tools of developers
        for need in needs
    ]
    names = {re.split(r"[<>=!]", need)[0] for need in [*PROJECT["dependencies"], *extras]}
    assert {name for name in names if not re.search(rf"\b{name}\b", page)} == set()
