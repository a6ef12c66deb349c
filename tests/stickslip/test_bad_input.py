"""Every kind of bad request ends with one clear message, exit code 2, no traceback and nothing written."""

import gzip
import io
import os
import random
import zipfile

import pytest

GOOD = "time,SP,PV,OP\n" + "".join(f"{i},5,{4 + 0.1 * (i % 7):.1f},{50 + i % 5}\n" for i in range(100))
NOISE = random.Random(3).randbytes(3000)


def zipped(name: str) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr(name, "x")
    return buffer.getvalue()


# what it is, content, options, words the message must hold
FILES = [
    ("missing column", "time,SP,PV\n0,1,2\n1,1,2\n", [], ["OP", "'PV'", "--op"]),
    ("text in numbers", GOOD.replace("53\n", "many\n"), [], ["line 5", "'OP'", "'many'"]),
    ("unsorted time", "time,PV,OP\n0,4,50\n2,4,51\n1,4,52\n", [], ["line 4", "sort"]),
    ("repeated time", "time,PV,OP\n0,4,50\n1,4,51\n1,9,52\n", [], ["lines 3 and 4", "same time"]),
    ("binary noise", NOISE, [], ["binary"]),
    ("binary noise without zeros", NOISE.replace(b"\0", b""), [], ["UTF-8"]),
    ("empty", b"", [], ["empty"]),
    ("header only", "time,PV,OP\n", [], ["no rows"]),
    ("xlsx", zipped("xl/workbook.xml"), [], ["Excel", "CSV"]),
    ("zip", zipped("trend.csv"), [], ["no rows"]),
    ("gzip", gzip.compress(GOOD.encode())[:20], [], ["gzip", "damaged"]),
    ("pdf", b"%PDF-1.7", [], ["PDF"]),
    ("NUL bytes", GOOD.replace("53", "5\0"), [], ["zero bytes"]),
    ("ragged rows", "time,PV,OP\n0,4,50\n1,4\n2,4,52\n", [], ["line 3", "2 cells"]),
    ("UTF-16 without mark", GOOD.encode("utf-16-le"), [], ["UTF-16"]),
    ("UTF-32", GOOD.encode("utf-32"), [], ["binary"]),
    ("one huge line", "a," * 300_000 + "\n", [], ["header"]),
    ("prose", "Dear all, nothing here, really.\nYours\n", [], ["line 2"]),
    ("only text", "time,remark\n0,all well\n1,gone home\n", [], ["'remark'", "--pv"]),
    (
        "two loops",
        "time,F1.PV,F1.OP,F2.PV,F2.OP\n0,1,2,3,4\n1,1,2,3,4\n",
        ["--op-span", "0", "100"],
        ["2 loops", "--loop"],
    ),
    ("no such loop", "time,F1.PV,F1.OP\n0,1,2\n", ["--loop", "F9"], ["'F9'", "'F1'"]),
    ("duplicated header", "time,PV,PV,OP\n0,1,2,3\n", [], ["'PV'", "more than once"]),
    ("number too large", "time,PV,OP\n0,1,2\n1,1e400,2\n", [], ["line 3", "1e400"]),
    ("wrong --pv", GOOD, ["--pv", "FLOW"], ["'FLOW'", "'PV'"]),
    ("--op is the PV", GOOD, ["--op", "PV"], ["PV"]),
    ("one column for two", GOOD, ["--op", "PV", "--pv", "PV"], ["'PV'", "two signals"]),
    ("--op-span reversed", GOOD, ["--op-span", "100", "0"], ["(100, 0)", "low < high"]),
    ("--op-span equal", GOOD, ["--op-span", "50", "50"], ["(50, 50)", "low < high"]),
    ("--op-span nan", GOOD, ["--op-span", "nan", "100"], ["nan", "low < high"]),
    ("--op-span infinite", GOOD, ["--op-span", "0", "inf"], ["inf", "finite"]),
    ("--op-span text", GOOD, ["--op-span", "low", "high"], ["'low'"]),
    ("--op-span once", GOOD, ["--op-span", "0"], ["--op-span"]),
    ("unknown --process", GOOD, ["--process", "runaway"], ["'runaway'", "integrating"]),
    ("--decimal", GOOD, ["--decimal", "x"], ["'x'"]),
    ("--separator", GOOD, ["--separator", ";"], ["one column"]),
    ("--interval", GOOD, ["--interval", "-1"], ["-1.0", "positive"]),
    ("--time-format", GOOD, ["--time-format", "%d/%m"], ["%d/%m"]),
    ("unknown option", GOOD, ["--sample"], ["--sample"]),
    ("--json into no folder", GOOD, ["--json", "absent/x.json"], ["--json absent/x.json", "no folder", "make it"]),
    ("--json into a folder", GOOD, ["--json", "."], ["'.'", "folder", "name a file"]),
    ("--json nameless", GOOD, ["--json", ""], ["--json ''", "name one"]),
    ("--html into no folder", GOOD, ["--html", "absent/x.html"], ["--html absent/x.html", "no folder"]),
    ("--html to standard output", GOOD, ["--html", "-"], ["--html -", "name a file"]),
    ("--html over --json", GOOD, ["--html", "x", "--json", "x"], ["--json x", "overwrite", "--html"]),
    ("--json over the input", GOOD, ["--json", "input.csv"], ["input.csv", "overwrite"]),
    ("name too long", GOOD, ["--json", "x" * 300], ["too long"]),
]


@pytest.mark.parametrize(("content", "options", "words"), [case[1:] for case in FILES], ids=[case[0] for case in FILES])
def test_check_refuses(call, tmp_path, monkeypatch, content, options, words):
    monkeypatch.chdir(tmp_path)
    data = content if isinstance(content, bytes) else content.encode()
    (tmp_path / "input.csv").write_bytes(data)
    result = call("check", "input.csv", *options)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "Error: " in result.stderr and "Traceback" not in result.stderr
    assert len(result.stderr) < 2000
    for word in words:
        assert word in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["input.csv"]
    assert (tmp_path / "input.csv").read_bytes() == data


def test_there_are_at_least_thirty_kinds():
    assert len(FILES) >= 30


def test_no_such_file(call, tmp_path):
    result = call("check", tmp_path / "absent.csv")
    assert result.exit_code == 2 and "absent.csv: no such file; check the path" in result.stderr


def test_folder(call, tmp_path):
    result = call("check", tmp_path)
    assert result.exit_code == 2 and "folder; name one file in it" in result.stderr


def test_circular_link(call, tmp_path):
    (tmp_path / "a").symlink_to(tmp_path / "b")
    (tmp_path / "b").symlink_to(tmp_path / "a")
    result = call("check", tmp_path / "a")
    assert result.exit_code == 2 and "symbolic links" in result.stderr


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="no device files on this system")
@pytest.mark.parametrize("device", ["/dev/null", "/dev/zero"])
def test_device(call, device):
    result = call("check", device)
    assert result.exit_code == 2 and "is a device, not a file" in result.stderr


@pytest.mark.skipif(hasattr(os, "geteuid") and os.geteuid() == 0, reason="the superuser may read and write anything")
def test_no_permission(call, good, tmp_path):
    closed = tmp_path / "closed"
    closed.mkdir()
    closed.chmod(0o500)
    result = call("check", good, "--json", closed / "x.json")
    assert result.exit_code == 2 and "no permission" in result.stderr
    good.chmod(0)
    result = call("check", good)
    assert result.exit_code == 2 and "permission denied" in result.stderr


# arguments, words
REQUESTS = [
    ([], ["Usage", "Start here"]),
    (["chek", "x.csv"], ["'chek'", "did you mean 'check'?", "simulate"]),
    (["input.csv"], ["'input.csv'", "stickslip check input.csv"]),
    (["check"], ["FILE"]),
    (["simulate"], ["CASE"]),
    (["simulate", "ideal_hi"], ["'ideal_hi'", "did you mean 'ideal_high'?"]),
    (["simulate", "xyz"], ["'xyz'", "ideal_normal"]),
    (["simulate", "sine", "--set", "nonsense"], ["nonsense", "BLOCK.PARAM=NUMBER"]),
    (["simulate", "ideal_high", "--set", "valve.F_s=much"], ["valve.F_s=much", "BLOCK.PARAM=NUMBER"]),
    (["simulate", "ideal_high", "--set", "valv.F_s=1"], ["'valv'", "did you mean 'valve'?"]),
    (["simulate", "ideal_high", "--set", "valve.F_x=1"], ["'F_x'", "did you mean 'F_v'?"]),
    (["simulate", "ideal_high", "--set", "F_s=1"], ["'F_s'", "block"]),
    (["simulate", "ideal_high", "--set", "valve.F_s=nan"], ["F_s = nan"]),
    (["simulate", "ideal_high", "--set", "valve.F_s=-1"], ["F_s = -1.0", "F_s >= F_c"]),
    (["simulate", "sine", "--duration", "-1"], ["-1.0", "positive"]),
    (["simulate", "sine", "--duration", "0"], ["0.0", "positive"]),
    (["simulate", "sine", "--duration", "nan"], ["nan", "positive"]),
    (["simulate", "sine", "--duration", "inf"], ["inf", "positive"]),
    (["simulate", "sine", "--duration", "1e15"], ["1e+16 rows", "--every"]),
    (["simulate", "sine", "--every", "1e-9"], ["6e+11 rows", "--every"]),
    (["simulate", "sine", "--every", "0"], ["0.0", "positive"]),
    (["simulate", "sine", "--every", "601"], ["601", "at most the duration, 600.0 s"]),
    (["simulate", "sine", "--out", "log.xls"], ["--out log.xls", "'.xls'", ".parquet"]),
    (["simulate", "sine", "--out", "log"], ["--out log", ".csv"]),
    (["simulate", "sine", "--out", "absent/log.csv"], ["--out absent/log.csv", "no folder"]),
    (["simulate", "sine", "--out", "log.csv", "--plot", "x.bmp"], ["--plot x.bmp", "'.bmp'", ".png"]),
    (["simulate", "sine", "--out", "log.csv", "--diagram", "x.bmp"], ["--diagram x.bmp", "'.bmp'"]),
    (["simulate", "sine", "--out", "log.csv", "--json", "absent/x"], ["--json absent/x", "no folder"]),
    (["simulate", "sine", "--out", "x.csv", "--json", "x.csv"], ["--json x.csv", "overwrite", "--out"]),
    (["demo", "--out", "input.csv"], ["--out input.csv", "is a file", "name a folder"]),
    (["demo", "--out", "input.csv/deeper"], ["--out input.csv/deeper", "is a file"]),
    (["study", "ideal_high", "--out", "input.csv"], ["--out input.csv", "is a file", "name a folder"]),
    (["study", "ideal_high", "--out", "input.csv/deeper"], ["--out input.csv/deeper", "is a file"]),
    (["scan", "input.csv", "--out", "input.csv"], ["--out input.csv", "is a file", "name a folder"]),
    (["demo", "--json", "absent/x.json"], ["--json absent/x.json", "no folder"]),
]


@pytest.mark.parametrize(("arguments", "words"), REQUESTS, ids=[" ".join(r[0]) or "nothing" for r in REQUESTS])
def test_requests_that_make_no_sense(call, tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "input.csv").write_text(GOOD)
    result = call(*arguments)
    assert result.exit_code == 2
    assert "Traceback" not in result.stderr
    for word in words:
        assert word in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["input.csv"]


def test_a_process_ends_the_same_way(shell, tmp_path):
    done = shell("check", tmp_path / "absent.csv")
    assert done.returncode == 2
    assert done.stdout == b""
    assert done.stderr.decode() == f"Error: {tmp_path / 'absent.csv'}: no such file; check the path and the name\n"


@pytest.mark.parametrize("place", ["study", "scan"])
def test_a_folder_that_cannot_be_written_is_refused_before_any_work(call, tmp_path, monkeypatch, place):
    """Permissions stop no superuser, so a system folder in which nothing can be made is asked for."""
    if not os.path.isdir("/proc/self"):
        pytest.skip("no /proc on this system: nothing else refuses the superuser")

    def work(*_, **__):
        raise AssertionError("work began")

    monkeypatch.setattr("stickslip.study.run.as_subject", work)
    monkeypatch.setattr("stickslip.commands.study.subject_of", work)
    (tmp_path / "input.csv").write_text(GOOD)
    given = [tmp_path / "input.csv"] if place == "scan" else ["ideal_high", "--vary", "valve.F_s=1750,2250"]
    result = call(place, *given, "--out", "/proc/self/results")
    assert result.exit_code == 2 and "nothing can be written in '/proc/self'" in result.stderr
