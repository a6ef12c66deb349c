"""A file of the user's that hides a package is named, not run."""

import pytest


@pytest.mark.parametrize("name", ["plant.py", "records/__init__.py", "control.py", "numpy/__init__.py", "click.py"])
def test_a_users_file_is_named(shell, tmp_path, name):
    file = tmp_path / name
    file.parent.mkdir(exist_ok=True)
    file.write_text("raise RuntimeError('not ours')\n")
    done = shell("simulate", "sine", cwd=tmp_path)
    message = done.stderr.decode()
    assert done.returncode == 2 and done.stdout == b""
    assert message.startswith("Error: ") and "Traceback" not in message
    assert str(tmp_path / name.removesuffix("/__init__.py")) in message
    assert f"'{name.split('/')[0].removesuffix('.py')}'" in message and "rename" in message


def test_a_plain_folder_of_that_name_is_no_trouble(shell, tmp_path):
    (tmp_path / "records").mkdir()
    (tmp_path / "records" / "FIC1.csv").write_text("time,PV,OP\n0,1,2\n")
    assert shell("check", "records/FIC1.csv", cwd=tmp_path).returncode == 0
