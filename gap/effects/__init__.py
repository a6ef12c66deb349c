"""The catalogue: one file an effect.  ``CATALOGUE`` lists them all; a name bears one effect, ``effect("stiction")``."""

from collections.abc import Iterable

from stickslip.blocks.ports import nearest
from stickslip.gap.effects.boil_off_rate import BoilOffRate
from stickslip.gap.effects.compression import Compression
from stickslip.gap.effects.compressor_fouling import CompressorFouling
from stickslip.gap.effects.compressor_map_shift import CompressorMapShift
from stickslip.gap.effects.controller_filter import ControllerFilter
from stickslip.gap.effects.controller_gain import ControllerGain
from stickslip.gap.effects.controller_integral_time import ControllerIntegralTime
from stickslip.gap.effects.controller_limits import ControllerLimits
from stickslip.gap.effects.dead_time import DeadTime
from stickslip.gap.effects.deadband import Deadband
from stickslip.gap.effects.derivative_action import DerivativeAction
from stickslip.gap.effects.gain_schedule import GainSchedule
from stickslip.gap.effects.gas_temperature import GasTemperature
from stickslip.gap.effects.horizontal_separator import HorizontalSeparator
from stickslip.gap.effects.lead import Lead
from stickslip.gap.effects.line_friction import LineFriction
from stickslip.gap.effects.positioner_lag import PositionerLag
from stickslip.gap.effects.process_gain import ProcessGain
from stickslip.gap.effects.process_time_constant import ProcessTimeConstant
from stickslip.gap.effects.quantisation import Quantisation
from stickslip.gap.effects.real_gas import RealGas
from stickslip.gap.effects.recycle_leak import RecycleLeak
from stickslip.gap.effects.scan_time import ScanTime
from stickslip.gap.effects.second_lag import SecondLag
from stickslip.gap.effects.sensor_bias import SensorBias
from stickslip.gap.effects.sensor_drift import SensorDrift
from stickslip.gap.effects.sensor_lag import SensorLag
from stickslip.gap.effects.sensor_noise import SensorNoise
from stickslip.gap.effects.sensor_saturation import SensorSaturation
from stickslip.gap.effects.sensor_span import SensorSpan
from stickslip.gap.effects.setpoint_filter import SetpointFilter
from stickslip.gap.effects.setpoint_ramp import SetpointRamp
from stickslip.gap.effects.setpoint_weight import SetpointWeight
from stickslip.gap.effects.shaft_friction import ShaftFriction
from stickslip.gap.effects.sine_disturbance import SineDisturbance
from stickslip.gap.effects.slug import Slug
from stickslip.gap.effects.step_disturbance import StepDisturbance
from stickslip.gap.effects.stiction import Stiction
from stickslip.gap.effects.tank_overflow import TankOverflow
from stickslip.gap.effects.valve_characteristic import ValveCharacteristic
from stickslip.gap.effects.valve_gain import ValveGain
from stickslip.gap.effects.valve_leak import ValveLeak
from stickslip.gap.effects.valve_rate_limit import ValveRateLimit
from stickslip.gap.effects.valve_saturation import ValveSaturation
from stickslip.gap.effects.vapour_pressure import VapourPressure
from stickslip.gap.insertion.effect import Effect, EffectError


class Catalogue(tuple[Effect, ...]):
    """The effects that are tried, in order; as text it says how many there are.

    >>> Catalogue([Stiction()])
    <Catalogue of 1 effect>
    """

    def __repr__(self) -> str:
        return f"<Catalogue of {len(self)} effect{'' if len(self) == 1 else 's'}>"


CATALOGUE = Catalogue((
    Stiction(), Deadband(), ValveLeak(), ValveSaturation(), ValveRateLimit(), PositionerLag(), ValveCharacteristic(),
    ValveGain(),
    DeadTime(), ProcessGain(), ProcessTimeConstant(), SecondLag(), Lead(), TankOverflow(),
    SensorBias(), SensorDrift(), SensorSpan(), SensorLag(), SensorNoise(), Quantisation(), SensorSaturation(),
    Compression(),
    ControllerGain(), ControllerIntegralTime(), ControllerLimits(), ControllerFilter(), ScanTime(),
    DerivativeAction(), GainSchedule(), SetpointFilter(), SetpointRamp(), SetpointWeight(),
    SineDisturbance(), StepDisturbance(), Slug(),
    HorizontalSeparator(), BoilOffRate(), VapourPressure(), RealGas(), GasTemperature(),
    CompressorFouling(), CompressorMapShift(), RecycleLeak(), ShaftFriction(), LineFriction(),
))  # fmt: skip


def effect(name: str, catalogue: Iterable[Effect] = CATALOGUE) -> Effect:
    """Return an effect by name; raise ``EffectError`` with the nearest name if there is none.

    >>> effect("dead_time")
    <Effect dead_time at a process: theta [s]>
    """
    known = {one.name: one for one in catalogue}
    if name not in known:
        raise EffectError(f"there is no effect '{name}'; {nearest(name, list(known))}")
    return known[name]
