"""Every kind of file that cannot be read says what is wrong, where, and what to do."""

import gzip
import io
import os
import zipfile
from datetime import datetime

import pytest
from stickslip.logs import LogError, LoopRecord, ReadError, read_log, read_loop, read_loops
from stickslip.logs.files.form import Form


def zipped(*names: str) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name in names:
            archive.writestr(name, "x")
    return buffer.getvalue()


GOOD = "time,SP,PV,OP\n0,5,4,50\n1,5,4.1,51\n2,5,4.2,52\n"

# (what it is, content of the file, options of read_loop, words the message must hold)
FILES = [
    ("empty", b"", {}, ["empty", "0 bytes"]),
    ("blank lines only", "\n\n  \n", {}, ["no header and no rows"]),
    ("comments only", "# one\n# two\n", {}, ["no header and no rows"]),
    ("header only", "time,PV,OP\n", {}, ["header", "no rows", "PV"]),
    ("header and units only", "time,PV,OP\ns,m3/h,%\n", {}, ["units", "no rows"]),
    ("Excel workbook", zipped("xl/workbook.xml"), {}, [".xlsx", "CSV"]),
    ("zip archive of two files", zipped("trend.csv", "other.csv"), {}, ["zip", "2 files", "trend.csv"]),
    ("damaged zip archive", zipped("trend.csv")[:40], {}, ["zip", "damaged"]),
    ("archive in an archive", gzip.compress(gzip.compress(GOOD.encode())), {}, ["gzip", "another archive"]),
    ("nothing in an archive", gzip.compress(b""), {}, ["gzip", "empty"]),
    ("old Excel workbook", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + b"\0" * 100, {}, [".xls", "CSV"]),
    ("gzip that breaks off", gzip.compress(GOOD.encode())[:20], {}, ["gzip", "damaged"]),
    ("HDF5", b"\x89HDF\r\n\x1a\n" + b"\0" * 50, {}, ["HDF5"]),
    ("MATLAB", b"MATLAB 5.0 MAT-file" + b"\0" * 50, {}, ["MATLAB"]),
    ("PDF", b"%PDF-1.7\n%", {}, ["PDF"]),
    ("web page", "<!DOCTYPE html><html><body>Log in</body></html>", {}, ["web page"]),
    ("JSON", '{"PV": [1, 2]}', {}, ["JSON"]),
    ("binary noise with zeros", bytes(range(256)) * 4, {}, ["zero bytes", "binary"]),
    ("binary noise without zeros", bytes(range(1, 32)) * 20, {}, ["control characters", "binary"]),
    ("UTF-16 without its mark", GOOD.encode("utf-16-le"), {}, ["zero bytes", "UTF-8"]),
    ("undecodable", b"time,PV,OP\n0,1,\x81\x8d\n", {}, ["byte 15", "UTF-8"]),
    ("damaged Parquet", b"PAR1" + b"\x07" * 40 + b"PAR1", {}, ["Parquet", "damaged"]),
    ("one column", "PV\n1\n2\n", {}, ["only one column", "separator"]),
    ("wrong separator told", GOOD, {"separator": ";"}, ["only one column", "separator"]),
    ("separator of two characters", GOOD, {"separator": "||"}, ["'||'", "one character"]),
    ("no header", "0,4,50\n1,4,51\n", {}, ["line 1", "numbers", "header"]),
    ("no header, clock time", "2024-01-01 00:00:00,4,50\n2024-01-01 00:00:01,4,51\n", {}, ["line 1", "header"]),
    ("unnamed column", "time,,OP\n0,4,50\n", {}, ["column 2", "no name"]),
    ("repeated names", "time,PV,PV,OP\n0,1,2,3\n", {}, ["'PV'", "more than once", "different values"]),
    ("ragged: too short", "time,PV,OP\n0,4,50\n1,4\n2,4,52\n", {}, ["line 3", "2 cells", "3"]),
    ("ragged: too long", "time,PV,OP\n0,4,50\n1,4,5,1\n2,4,52\n", {}, ["line 3", "4 cells", "decimal mark"]),
    ("open quotation mark", 'time,PV,OP\n0,4,50\n1,"4,51\n', {}, ["line 3", "quotation mark"]),
    ("no time", "PV,OP\n4,50\n3,51\n4,52\n", {}, ["no column is plainly the time", "--time", "interval"]),
    ("no PV", "time,FT,OP\n0,4,50\n1,4,51\n", {}, ["no column is plainly the PV", "'FT'", "--pv"]),
    ("no OP", "time,PV,valve\n0,4,50\n1,4,51\n", {}, ["no column is plainly the OP", "'valve'", "--op"]),
    ("named column missing", GOOD, {"pv": "FLOW"}, ["'FLOW'", "PV", "'OP'"]),
    ("named time missing", GOOD, {"time": "clock"}, ["'clock'", "time", "'PV'"]),
    ("one column for two", GOOD, {"pv": "OP", "op": "OP"}, ["'OP'", "two signals"]),
    ("text in numbers", "time,PV,OP\n0,4,50\n1,four,51\n", {}, ["line 3", "'PV'", "'four'"]),
    ("marks between two digits", 'time,PV,OP\n0,"1,23,4.5",50\n1,4,51\n', {}, ["line 2", "'PV'", "1,23,4.5"]),
    ("two units in the cells", "time,PV,OP\n0,4,50 %\n1,4,51 mA\n", {}, ["line 2", "'OP'", "'50 %'"]),
    ("falling time", "time,PV,OP\n0,4,50\n2,4,51\n1,4,52\n", {}, ["line 4", "earlier", "sort"]),
    ("same time, other values", "time,PV,OP\n0,4,50\n1,4,51\n1,9,51\n", {}, ["lines 3 and 4", "same time"]),
    ("time not finite", "time,PV,OP\n0,4,50\nnan,4,51\n2,4,52\n", {}, ["line 3", "not finite"]),
    ("time missing", "time,PV,OP\n0,4,50\n,4,51\n2,4,52\n", {}, ["line 3", "no time"]),
    ("text in a time of numbers", "time,PV,OP\n0,4,50\n1,4,5\nx,4,51\n", {}, ["line 4", "'x'", "not a number"]),
    ("unreadable stamp", "time,PV,OP\n1st of May,4,50\n2nd of May,4,51\n", {}, ["line 2", "1st of May", "time_format"]),
    (
        "one odd stamp",
        "time,PV,OP\n2024-05-01 00:00:00,4,50\n2024-05-01 00:00:10,4,50\nyesterday,4,51\n",
        {},
        ["line 4", "yesterday"],
    ),
    ("no such day", "time,PV,OP\n2024-02-30 00:00:00,4,50\n2024-02-30 00:01:00,4,5\n", {}, ["2024-02-30"]),
    ("format does not fit", "time,PV,OP\n2024-05-01,4,50\n", {"time_format": "%d/%m/%y"}, ["%d/%m/%y", "line 2"]),
    ("two steps back", "time,PV,OP\n" + "".join(
        f"2024-10-27 0{h}:{m:02d}:00,1,50\n" for h in (2, 1, 0) for m in range(0, 60, 10)
    ), {}, ["line 8", "earlier", "UTC"]),
    ("interval not positive", GOOD, {"interval": 0.0}, ["interval = 0.0", "not positive"]),
    ("interval and time", GOOD, {"interval": 1.0, "time": "time"}, ["both"]),
    ("decimal mark", GOOD, {"decimal": "·"}, ["'·'", "neither"]),
    ("span turned round", GOOD, {"op_span": (100, 0)}, ["op_span", "(100, 0)", "low < high"]),
    ("span of nothing", GOOD, {"op_span": (50, 50)}, ["op_span", "(50, 50)"]),
    ("two loops", "time,FIC1.PV,FIC1.OP,FIC2.PV,FIC2.OP\n0,1,2,3,4\n", {}, ["2 loops", "'FIC1'", "--loop"]),
    ("no such loop", "time,FIC1.PV,FIC1.OP\n0,1,2\n", {"loop": "FIC9"}, ["'FIC9'", "'FIC1'"]),
    ("unknown process", GOOD, {"process": "runaway"}, ["'runaway'", "integrating"]),
]  # fmt: skip


@pytest.mark.parametrize(("content", "options", "words"), [case[1:] for case in FILES], ids=[case[0] for case in FILES])
def test_refused_with_reason(write, content, options, words):
    path = write(content)
    with pytest.raises(ReadError) as caught:
        read_loop(path, **options)
    message = str(caught.value)
    assert message.startswith(f"{path}: "), "the message begins with the file"
    for word in words:
        assert word in message


def test_there_are_enough_kinds():
    assert len(FILES) >= 30


def test_no_such_file(tmp_path):
    with pytest.raises(ReadError, match=r"absent\.csv: no such file"):
        read_loop(tmp_path / "absent.csv")


def test_folder(tmp_path):
    with pytest.raises(ReadError, match="folder"):
        read_loop(tmp_path)


def test_null_byte_in_the_path():
    with pytest.raises(ReadError, match="cannot be opened"):
        read_loop("trend\0.csv")


def test_permission_denied(write, monkeypatch):
    path = write(GOOD)
    path.chmod(0)
    if os.access(path, os.R_OK):  # the superuser may read anything: let the system call refuse instead

        def refuse(self):
            raise PermissionError(13, "Permission denied")

        monkeypatch.setattr("pathlib.Path.read_bytes", refuse)
    with pytest.raises(ReadError, match="permission denied"):
        read_loop(path)


def test_only_text(write):
    path = write("time,remark\n0,all well\n1,gone home\n")
    with pytest.raises(ReadError, match="no column beside the time holds a number"):
        read_log(path)


def test_wanted_column_missing(write):
    with pytest.raises(ReadError, match="no column 'FLOW' for 'PV'"):
        read_log(write(GOOD), columns={"PV": "FLOW"})


def test_long_form_with_two_values_at_one_time(write):
    text = "tag,time,value\nFIC1.PV,0,1\nFIC1.PV,0,2\nFIC1.OP,0,50\n"
    with pytest.raises(ReadError, match=r"lines 2 and 3 of 'FIC1.PV' have the same time"):
        read_loop(write(text))


def test_errors_are_value_errors():
    # Callers that know nothing of this package catch them all the same.
    assert issubclass(ReadError, ValueError)
    assert issubclass(LogError, ValueError)


@pytest.mark.parametrize(
    ("content", "samples"),
    [
        ("time,PV,OP\n0,4,50\n", 1),
        ("time,PV,OP\n0,4,50\n1,4,50\n2,4,50\n", 3),
        ("time,PV,OP\n0,Bad,50\n1,Bad,50\n", 2),
    ],
    ids=["one row", "constant", "nothing good"],
)
def test_unfit_data_are_read(write, content, samples):
    """Whether data are enough is for the detectors to say."""
    loop = read_loop(write(content))
    assert isinstance(loop, LoopRecord)
    assert len(loop) == samples
    assert loop.notes


def test_all_readers_are_told_the_same_of_a_file(write):
    """Each argument reaches all three readers; a misspelt one gets the right one named."""
    path = write("when;PV;OP\n01.02.2024 00:00;4,5;50\n01.02.2024 00:01;4,6;51\n01.02.2024 00:02;4,7;52\n")
    form = {"time": "when", "time_format": "%d.%m.%Y %H:%M", "decimal": ",", "separator": ";"}
    log, loop, (same,) = read_log(path, **form), read_loop(path, **form), read_loops(path, **form)
    assert log["PV"].tolist() == loop.pv.tolist() == same.pv.tolist() == [4.5, 4.6, 4.7]
    assert log.start == loop.log.start == same.log.start == datetime(2024, 2, 1)
    assert {"interval", "time_unit"} | form.keys() == set(Form.__annotations__)
    for reader in (read_log, read_loop, read_loops):
        with pytest.raises(TypeError, match="'time_units' is no argument of a reader; did you mean 'time_unit'"):
            reader(path, time_units="s")
