"""Archives of one file and workbooks read as the table in them, and never fill the memory."""

import gzip
import io
import zipfile
from xml.sax.saxutils import escape

import pytest
from stickslip.logs import ReadError, read_log, read_loop
from stickslip.logs.files.packed import unpacked

ROWS = [["Trend of unit 3", None, None], ["Time", "FIC1.PV", "FIC1.OP"]] + [
    [45579.5 + 10 * i / 86400, 4.0 + 0.25 * (i % 5), 50.0 + 0.5 * (i % 3)] for i in range(30)
]
TEXT = "\n".join(",".join("" if cell is None else str(cell) for cell in row) for row in ROWS[1:]) + "\n"


def workbook(*sheets: tuple[str, list[list[object]]]) -> bytes:
    """A workbook by hand: the format is a zip archive of a few XML files (ECMA-376)."""
    main, office = "http://schemas.openxmlformats.org", "application/vnd.openxmlformats-officedocument"
    link = f'Type="{main}/officeDocument/2006/relationships'
    books, links, types, files = "", "", "", {}
    for i, (name, rows) in enumerate(sheets, start=1):
        books += f'<sheet name="{name}" sheetId="{i}" r:id="rId{i}"/>'
        links += f'<Relationship Id="rId{i}" {link}/worksheet" Target="worksheets/sheet{i}.xml"/>'
        types += (
            f'<Override PartName="/xl/worksheets/sheet{i}.xml" ContentType="{office}.spreadsheetml.worksheet+xml"/>'
        )
        cells = "".join(
            f'<row r="{r}">'
            + "".join(
                f'<c r="{chr(65 + c)}{r}" t="inlineStr"><is><t>{escape(cell)}</t></is></c>'
                if isinstance(cell, str)
                else f'<c r="{chr(65 + c)}{r}"' + (' s="1"' if c == 0 else "") + f"><v>{cell!r}</v></c>"
                for c, cell in enumerate(row)
                if cell is not None
            )
            + "</row>"
            for r, row in enumerate(rows, start=1)
        )
        files[f"xl/worksheets/sheet{i}.xml"] = (
            f'<worksheet xmlns="{main}/spreadsheetml/2006/main"><sheetData>{cells}</sheetData></worksheet>'
        )
    files["[Content_Types].xml"] = (
        f'<Types xmlns="{main}/package/2006/content-types"><Default Extension="rels" '
        'ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Override PartName="/xl/workbook.xml" '
        f'ContentType="{office}.spreadsheetml.sheet.main+xml"/><Override PartName="/xl/styles.xml" '
        f'ContentType="{office}.spreadsheetml.styles+xml"/>{types}</Types>'
    )
    files["_rels/.rels"] = (
        f'<Relationships xmlns="{main}/package/2006/relationships"><Relationship Id="rId1" '
        f'Type="{main}/officeDocument/2006/relationships/officeDocument" Target="xl/workbook.xml"/></Relationships>'
    )
    files["xl/workbook.xml"] = (
        f'<workbook xmlns="{main}/spreadsheetml/2006/main" xmlns:r="{main}/officeDocument/2006/relationships">'
        f"<sheets>{books}</sheets></workbook>"
    )
    files["xl/_rels/workbook.xml.rels"] = (
        f'<Relationships xmlns="{main}/package/2006/relationships">{links}<Relationship Id="rId99" '
        f'Type="{main}/officeDocument/2006/relationships/styles" Target="styles.xml"/></Relationships>'
    )
    files["xl/styles.xml"] = (  # format 22 is a date with its clock time
        f'<styleSheet xmlns="{main}/spreadsheetml/2006/main"><fonts><font/></fonts><fills><fill/></fills>'
        '<borders><border/></borders><cellStyleXfs><xf/></cellStyleXfs><cellXfs><xf numFmtId="0"/>'
        '<xf numFmtId="22" applyNumberFormat="1"/></cellXfs></styleSheet>'
    )
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return buffer.getvalue()


def zipped(**files: str) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.mkdir("trends")
        for name, text in files.items():
            archive.writestr(f"trends/{name}.csv", text)
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("name", "raw", "note_of"),
    [
        ("gzip", gzip.compress(TEXT.encode()), "gzip"),
        ("zip", zipped(trend=TEXT), "zip"),
        ("utf-16 in gzip", gzip.compress(TEXT.encode("utf-16")), "gzip"),
        ("workbook", workbook(("Notes", [["by hand"]]), ("Trend", ROWS)), "the sheet 'Trend'"),
        ("workbook in zip", None, "the sheet 'Trend'"),
    ],
)
def test_reads_as_the_table_in_it(tmp_path, name, raw, note_of) -> None:
    if raw is None:
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w") as archive:
            archive.writestr("trend.xlsx", workbook(("Trend", ROWS)))
        raw = buffer.getvalue()
    if "workbook" in name:
        pytest.importorskip("python_calamine")
    file = tmp_path / "trend.bin"
    file.write_bytes(raw)
    loop = read_loop(file)
    assert (loop.name, len(loop.t), loop.dt) == ("FIC1", 30, pytest.approx(10.0, abs=1e-3))
    assert loop.pv.tolist() == [row[1] for row in ROWS[2:]]
    assert loop.op.tolist() == [row[2] for row in ROWS[2:]]
    assert any(note_of in note for note in loop.notes)


def test_dates_of_a_workbook_are_dates(tmp_path) -> None:
    pytest.importorskip("python_calamine")
    file = tmp_path / "trend.xlsx"
    file.write_bytes(workbook(("Trend", ROWS)))
    # analytic: day 45579.5 of a spreadsheet, counted from 1899-12-30, is noon of 2024-10-14
    assert read_log(file).start.isoformat()[:16] == "2024-10-14T12:00"


def test_a_bomb_is_refused_before_it_is_unpacked_whole() -> None:
    bomb = gzip.compress(b"0" * 5_000_000)
    assert len(bomb) < 10_000
    for packed in (bomb, zipped(trend="0" * 5_000_000)):
        with pytest.raises(ReadError, match="larger than 1 MB"):
            unpacked(packed, most=1_000_000)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("xl/worksheets/sheet1.xml", "0" * 5_000_000)
    with pytest.raises(ReadError, match="unpacks to 5 MB"):
        unpacked(buffer.getvalue(), most=1_000_000)


def test_a_workbook_without_a_table_and_a_damaged_one(tmp_path) -> None:
    pytest.importorskip("python_calamine")
    file = tmp_path / "trend.xlsx"
    file.write_bytes(workbook(("Notes", [["by hand"]])))
    with pytest.raises(ReadError, match="no sheet of the workbook holds a table"):
        read_loop(file)
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("xl/workbook.xml", "<broken")
    with pytest.raises(ReadError, match="damaged or locked"):
        read_loop(file)


@pytest.mark.parametrize(
    "words",
    [[["Export Mill 2", None], ["by", "K. Muster"]], [["Export", "of"], ["Mill", "2"]], [["by", "on"], ["K", 45579]]],
)
def test_sheets_of_words_before_the_data_are_passed_over(tmp_path, words) -> None:
    pytest.importorskip("python_calamine")
    file = tmp_path / "trend.xlsx"
    file.write_bytes(workbook(("Info", words), ("Trend", ROWS)))
    loop = read_loop(file)
    assert (loop.name, len(loop.t)) == ("FIC1", 30)
    assert any("the sheet 'Trend'" in note for note in loop.notes)


def test_what_is_wrong_with_a_sheet_names_it_and_no_separator(tmp_path) -> None:
    pytest.importorskip("python_calamine")
    file = tmp_path / "trend.xlsx"
    file.write_bytes(workbook(("Trend", [["Time", "FIC1.PV", None], *[[45579.5, 4.0, 5.0]] * 5])))
    with pytest.raises(ReadError, match="sheet 'Trend': column 3 has no name") as refused:
        read_loop(file)
    assert "separator" not in str(refused.value)
    file.write_bytes(workbook(("Info", [["by", "on"], ["K", "Monday"]]), ("Notes", [["a", "b"], ["c", "d"]])))
    with pytest.raises(ReadError, match=r"sheet 'Info': .*; sheet 'Notes': "):
        read_loop(file)
