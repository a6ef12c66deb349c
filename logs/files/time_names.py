"""Which columns hold the time, and which unit their names tell."""

from __future__ import annotations

import re

__all__ = ["TIME_UNITS", "is_clock_name", "is_date_name", "is_time_name", "unit_in_name", "unit_named"]

TIME_UNITS = ("s", "ms", "us", "ns", "min", "h", "d", "filetime", "datenum", "excel", "labview", "ticks")

_UNIT_WORDS = {
    "s": "s sec secs second seconds sek sekunden sekunder segundos secondes",
    "ms": "ms msec msecs millis millisec millisecond milliseconds millisekunden millitm",
    "us": "us µs μs usec micros microsecond microseconds",
    "ns": "ns nsec nanos nanosecond nanoseconds",
    "min": "min mins minute minutes minuten minutos",
    "h": "h hr hrs hour hours std stunden stunde heures horas timer",
    "d": "d day days tage jours dias",
    "filetime": "filetime",
    "datenum": "datenum matlabdatenum",
    "excel": "excel exceltime exceldate serialdate",
    "labview": "labview",
    "ticks": "ticks",
}
_UNIT_OF = {word: unit for unit, words in _UNIT_WORDS.items() for word in words.split()}
# Alone, without "time" before them, only words that can mean nothing else are taken as a time.
_UNIT_ALONE = {word for word in _UNIT_OF if len(word) > 3 and word not in ("timer", "excel", "labview", "ticks")}
_TIMES = {
    "time", "timestamp", "datetime", "timestamps", "t", "ts", "dateandtime", "sampletime", "times", "utc",
    "localtime", "timeutc", "sourcetime", "sourcetimestamp", "servertime", "servertimestamp", "serverts", "datum",
    "clock",
    "dt", "elapsedtime", "seconds", "timelocal", "tid", "zeit", "eventtime", "timeofday", "tstamp",
    "timeseconds",
    "timestamputc", "utctime", "utctimestamp", "timestamplocal", "localtimestamp", "datetimeutc", "datetimelocal",
    "logtime", "recordtime", "valuetime", "timestring", "elapsed", "relativetime", "epoch", "epochtime",
    "unix", "unixtime", "unixtimestamp", "posix", "posixtime", "zeitstempel", "uhrzeit", "datumuhrzeit", "datumzeit",
    "horodatage", "horodate", "dateheure", "heure", "fechahora", "fecha", "hora", "tiempo", "marcadetiempo",
    "datahora", "dataora", "tempo", "tidspunkt", "tidsstempel", "tidsstampel", "dato", "datotid", "tijd", "tijdstip",
    "aikaleima", "aika", "czas", "indexlevel0",
    "时间", "時間", "时间戳", "日期时间", "采集时间", "采样时间", "日時", "時刻", "时刻", "시간", "일시",
}  # fmt: skip
_DATES = {"date", "datum", "dato", "fecha", "data", "jour", "giorno", "dag", "日期", "日付", "날짜"}
_CLOCKS = {
    "time", "uhrzeit", "zeit", "heure", "hora", "ora", "tid", "klokkeslett", "klokkeslaet", "tijd", "timeofday",
    "时间", "時間", "時刻", "时刻", "시간",
}  # fmt: skip


def is_time_name(name: str) -> bool:
    """Whether a column of this name holds the time.

    >>> [is_time_name(name) for name in ("Time Stamp", "elapsed_ms", "Zeitstempel", "PV", "OP_min")]
    [True, True, True, False, False]
    """
    return _plain(name) in _TIMES or bool(unit_in_name(name))


def unit_in_name(name: str) -> str:
    """The unit that a time column's name ends in, one of ``TIME_UNITS``, "" when it tells none.

    >>> [unit_in_name(name) for name in ("time_ms", "TimeMs", "Elapsed hours", "t_us", "milliseconds", "time", "rpm_s")]
    ['ms', 'ms', 'h', 'us', 'ms', '', '']
    """
    words = [word.casefold() for word in re.findall(r"[^\W\d_]+", re.sub(r"([a-z])([A-Z])", r"\1 \2", name))]
    whole = "".join(words)
    if whole in _UNIT_ALONE:
        return _UNIT_OF[whole]
    if len(words) > 1 and words[-1] in _UNIT_OF and "".join(words[:-1]) in _TIMES:
        return _UNIT_OF[words[-1]]
    return ""


def unit_named(word: str) -> str | None:
    """One of ``TIME_UNITS`` for a unit as people write it, None if it is not known.

    >>> unit_named("msec"), unit_named("Hours"), unit_named("furlong")
    ('ms', 'h', None)
    """
    return _UNIT_OF.get(re.sub(r"[\s._-]", "", word.casefold()))


def is_date_name(name: str) -> bool:
    """Whether a column of this name may hold dates whose clock time stands in another column."""
    return _plain(name) in _DATES


def is_clock_name(name: str) -> bool:
    """Whether a column of this name may hold the clock time whose date stands in another column."""
    return _plain(name) in _CLOCKS


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9\u3040-\u9fff\uac00-\ud7af]", "", name.casefold())
