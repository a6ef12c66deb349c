"""The signals of a prepared loop under the names of its record: a method may be a function of a record alone."""

from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values


class RecordSignals:
    """Signals of ``record``, whose stale samples are missing."""

    record: LoopRecord

    def __len__(self) -> int:
        return len(self.record)

    @property
    def t(self) -> Values:
        """Times (n,) [s]."""
        return self.record.t

    @property
    def op(self) -> Values:
        """Controller output (n,), in the unit of the record."""
        return self.record.op

    @property
    def pv(self) -> Values:
        """Process variable (n,), in the unit of the record."""
        return self.record.pv

    @property
    def sp(self) -> Values | None:
        """Set point (n,), or None where it is not logged."""
        return self.record.sp

    @property
    def mv(self) -> Values | None:
        """Stem position (n,), or None where it is not logged."""
        return self.record.mv

    @property
    def e(self) -> Values | None:
        """Control error SP - PV (n,), or None without SP."""
        return self.record.e

    @property
    def dt(self) -> float:
        """Usual sampling interval [s]."""
        return self.record.dt

    @property
    def name(self) -> str:
        """Name of the loop."""
        return self.record.name
