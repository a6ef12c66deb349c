"""Blocks: one python-control nonlinear I/O system per file, made of pure kernels.

sources      Constant Step Ramp Sine Square Triangle Slug Staircase Recorded Noise PRBS Chirp
log on top   Pin (of a signal)   Historian (reads, gives nothing)
controllers  PI PID SampledPI GapPI RelayTuner
against stick  Knocker ConstantReinforcement TwoMove (between controller and valve)
valves       StickSlip StribeckStem LuGreStem QuasiStaticStem (physical)   Deadband IdealValve Characteristic
             Positioner (pneumatic, in front of a stem)
             KanoValve ChoudhuryValve HeValve ChenValve StenmanValve (two-parameter, sampled)
processes    FirstOrder SecondOrder Integrator DeadTime VariableDelay Tank Overflow
sensors      Sensor SampledSensor
arithmetic   Sum Gain Product Divide Lookup1D Lookup2D
switching    Saturation DeadZone Quantiser RateLimiter Relay Switch MinSelect MaxSelect
filters      LeadLag SampledFilter Biquad ZeroOrderHold ResetIntegrator
any system   StateSpace TransferFunction   Equations SampledFunction (plain functions)   as_block (of python-control)
plant        Separator Scrubber ControlValveFlow GasValveFlow CheckValve FlowResistance Plenum Compressor
             (CubicMap, TabulatedMap) AntiSurge Shaft GasTurbine Flare
"""

from blocks.anti_surge import AntiSurge
from blocks.arithmetic import Gain, Sum
from blocks.biquad import Biquad
from blocks.block import Block, Host, Kernels
from blocks.characteristic import Characteristic
from blocks.check_valve import CheckValve
from blocks.chen_valve import ChenValve
from blocks.chirp import Chirp
from blocks.choudhury_valve import ChoudhuryValve
from blocks.compressor import Compressor
from blocks.compressor_map import CubicMap
from blocks.constant_reinforcement import ConstantReinforcement
from blocks.control_system import as_block
from blocks.control_valve_flow import ControlValveFlow
from blocks.dead_time import DeadTime
from blocks.dead_zone import DeadZone
from blocks.deadband import Deadband
from blocks.equations import Equations
from blocks.first_order import FirstOrder
from blocks.flare import Flare
from blocks.flow_resistance import FlowResistance
from blocks.gap_pi import GapPI
from blocks.gas_turbine import GasTurbine
from blocks.gas_valve_flow import GasValveFlow
from blocks.he_valve import HeValve
from blocks.historian import Historian
from blocks.ideal_valve import IdealValve
from blocks.integrator import Integrator
from blocks.kano_valve import KanoValve
from blocks.knocker import Knocker
from blocks.lead_lag import LeadLag
from blocks.lookup_1d import Lookup1D
from blocks.lookup_2d import Lookup2D
from blocks.lugre_stem import LuGreStem
from blocks.noise import Noise
from blocks.overflow import Overflow
from blocks.periodic import Sine, Slug, Square, Triangle
from blocks.pi import PI
from blocks.pid import PID
from blocks.pin import Pin
from blocks.plenum import Plenum
from blocks.ports import BlockError, Labels, Port
from blocks.positioner import Positioner
from blocks.prbs import PRBS
from blocks.product import Divide, Product
from blocks.quantiser import Quantiser
from blocks.quasi_static_stem import QuasiStaticStem
from blocks.rate_limiter import RateLimiter
from blocks.recorded import Recorded, Staircase
from blocks.relay import Relay
from blocks.relay_tuner import RelayTuner
from blocks.reset_integrator import ResetIntegrator
from blocks.sampled_filter import SampledFilter
from blocks.sampled_function import SampledFunction
from blocks.sampled_pi import SampledPI
from blocks.saturation import Saturation
from blocks.scrubber import Scrubber
from blocks.second_order import SecondOrder
from blocks.select import MaxSelect, MinSelect
from blocks.sensor import SampledSensor, Sensor
from blocks.separator import Separator
from blocks.shaft import Shaft
from blocks.sources import Constant, Ramp, Step
from blocks.state_space import StateSpace
from blocks.stenman_valve import StenmanValve
from blocks.stick_slip import StickSlip
from blocks.stribeck_stem import StribeckStem
from blocks.switch import Switch
from blocks.tabulated_map import TabulatedMap
from blocks.tank import Tank
from blocks.transfer_function import TransferFunction
from blocks.two_move import TwoMove
from blocks.variable_delay import VariableDelay
from blocks.zero_order_hold import ZeroOrderHold

__all__ = [
    "PI",
    "PID",
    "PRBS",
    "AntiSurge",
    "Biquad",
    "Block",
    "BlockError",
    "Characteristic",
    "CheckValve",
    "ChenValve",
    "Chirp",
    "ChoudhuryValve",
    "Compressor",
    "Constant",
    "ConstantReinforcement",
    "ControlValveFlow",
    "CubicMap",
    "DeadTime",
    "DeadZone",
    "Deadband",
    "Divide",
    "Equations",
    "FirstOrder",
    "Flare",
    "FlowResistance",
    "Gain",
    "GapPI",
    "GasTurbine",
    "GasValveFlow",
    "HeValve",
    "Historian",
    "Host",
    "IdealValve",
    "Integrator",
    "KanoValve",
    "Kernels",
    "Knocker",
    "Labels",
    "LeadLag",
    "Lookup1D",
    "Lookup2D",
    "LuGreStem",
    "MaxSelect",
    "MinSelect",
    "Noise",
    "Overflow",
    "Pin",
    "Plenum",
    "Port",
    "Positioner",
    "Product",
    "Quantiser",
    "QuasiStaticStem",
    "Ramp",
    "RateLimiter",
    "Recorded",
    "Relay",
    "RelayTuner",
    "ResetIntegrator",
    "SampledFilter",
    "SampledFunction",
    "SampledPI",
    "SampledSensor",
    "Saturation",
    "Scrubber",
    "SecondOrder",
    "Sensor",
    "Separator",
    "Shaft",
    "Sine",
    "Slug",
    "Square",
    "Staircase",
    "StateSpace",
    "StenmanValve",
    "Step",
    "StickSlip",
    "StribeckStem",
    "Sum",
    "Switch",
    "TabulatedMap",
    "Tank",
    "TransferFunction",
    "Triangle",
    "TwoMove",
    "VariableDelay",
    "ZeroOrderHold",
    "as_block",
]
