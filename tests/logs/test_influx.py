"""Answers of Influx as annotated CSV: one value a row, with its measurement, field and tags in columns."""

import pytest
from stickslip.logs import ReadError, read_loops

STAMPS = [f"2024-05-06T07:{second // 60:02}:{second % 60:02}Z" for second in range(0, 400, 10)]


@pytest.mark.parametrize(
    ("extra", "names"),
    [
        ("", [("FIC101", "PV"), ("FIC101", "OP"), ("LIC7", "PV"), ("LIC7", "OP")]),
        ("", [("FIC101.PV", "value"), ("FIC101.OP", "value"), ("LIC7.PV", "value"), ("LIC7.OP", "value")]),
        ("", [("unit 3", name) for name in ("FIC101.PV", "FIC101.OP", "LIC7.PV", "LIC7.OP")]),
        ("tag", [("unit 3", *name) for name in (("PV", "FIC101"), ("OP", "FIC101"), ("PV", "LIC7"), ("OP", "LIC7"))]),
    ],
)
def test_an_export_of_influx_names_its_measurements(tmp_path, extra, names):
    rows = [
        "#group,false,false",
        ",result,table,_start,_stop,_time,_value,_measurement,_field" + f",{extra}" * bool(extra),
    ]
    span = "2024-05-06T07:00:00Z,2024-05-06T08:00:00Z"
    for k, name in enumerate(names):
        rows += [f",,{k},{span},{t},{10 * k + i % 7},{','.join(name)}" for i, t in enumerate(STAMPS)]
    path = tmp_path / "influx.csv"
    path.write_text("\n".join(rows))
    records = read_loops(path)
    assert [record.name for record in records] == ["FIC101", "LIC7"]
    assert records[1].pv[:3].tolist() == [20.0, 21.0, 22.0] and records[1].op[:3].tolist() == [30.0, 31.0, 32.0]


@pytest.mark.parametrize("between", ["", "\n"])
def test_an_answer_of_influx_in_blocks_of_other_columns(tmp_path, between):
    span = "2024-05-06T07:00:00Z,2024-05-06T08:00:00Z"
    rows = []
    for k, (field, header, more) in enumerate([("PV", "", ""), ("OP", ",unit", ',"%, of span"')]):
        rows += ["#datatype,string,long", "#group,false,false", "#default,_result,"]
        rows += [f",result,table,_start,_stop,_time{header},_value,_field,_measurement"]
        rows += [f",,{k},{span},{t}{more},{10 * k + i % 7},{field},FIC101" for i, t in enumerate(STAMPS)]
        rows += [between] * (between != "")
    path = tmp_path / "influx.csv"
    path.write_text("\n".join(rows))
    (record,) = read_loops(path)
    assert record.name == "FIC101" and len(record) == len(STAMPS)
    assert record.pv[:3].tolist() == [0.0, 1.0, 2.0] and record.op[:3].tolist() == [10.0, 11.0, 12.0]


def test_a_bad_row_of_a_later_block_is_named_by_its_line(tmp_path):
    head = ",result,table,_time,_value,_field,_measurement"
    path = tmp_path / "influx.csv"
    path.write_text("\n".join([head, ",,0,2024-05-06T07:00:00Z,1,PV,FIC1", "", head, ",,1,,4,OP,FIC1"]))
    with pytest.raises(ReadError, match="line 5"):
        read_loops(path)
