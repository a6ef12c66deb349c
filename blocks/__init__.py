"""Blocks: one python-control nonlinear I/O system per file, made of pure kernels.

sources      Constant Step Ramp Sine Square Triangle Slug Staircase Recorded Noise PRBS Chirp
log on top   Pin (of a signal)   Historian (reads, gives nothing)
controllers  PI PID SampledPI SampledPID GapPI RelayTuner
against stick  Knocker ConstantReinforcement TwoMove (between controller and valve)
valves       StickSlip StribeckStem LuGreStem QuasiStaticStem RestingStem (physical)   Deadband IdealValve
             Characteristic
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

from stickslip.blocks.anti_surge import AntiSurge
from stickslip.blocks.arithmetic import Gain, Sum
from stickslip.blocks.biquad import Biquad
from stickslip.blocks.block import Block, Host, Kernels
from stickslip.blocks.characteristic import Characteristic
from stickslip.blocks.check_valve import CheckValve
from stickslip.blocks.chen_valve import ChenValve
from stickslip.blocks.chirp import Chirp
from stickslip.blocks.choudhury_valve import ChoudhuryValve
from stickslip.blocks.compressor import Compressor
from stickslip.blocks.compressor_map import CubicMap
from stickslip.blocks.constant_reinforcement import ConstantReinforcement
from stickslip.blocks.control_system import as_block
from stickslip.blocks.control_valve_flow import ControlValveFlow
from stickslip.blocks.dead_time import DeadTime
from stickslip.blocks.dead_zone import DeadZone
from stickslip.blocks.deadband import Deadband
from stickslip.blocks.equations import Equations
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.flare import Flare
from stickslip.blocks.flow_resistance import FlowResistance
from stickslip.blocks.gap_pi import GapPI
from stickslip.blocks.gas_turbine import GasTurbine
from stickslip.blocks.gas_valve_flow import GasValveFlow
from stickslip.blocks.he_valve import HeValve
from stickslip.blocks.historian import Historian
from stickslip.blocks.ideal_valve import IdealValve
from stickslip.blocks.integrator import Integrator
from stickslip.blocks.kano_valve import KanoValve
from stickslip.blocks.knocker import Knocker
from stickslip.blocks.lead_lag import LeadLag
from stickslip.blocks.lookup_1d import Lookup1D
from stickslip.blocks.lookup_2d import Lookup2D
from stickslip.blocks.lugre_stem import LuGreStem
from stickslip.blocks.noise import Noise
from stickslip.blocks.overflow import Overflow
from stickslip.blocks.periodic import Sine, Slug, Square, Triangle
from stickslip.blocks.pi import PI
from stickslip.blocks.pid import PID
from stickslip.blocks.pin import Pin
from stickslip.blocks.plenum import Plenum
from stickslip.blocks.ports import BlockError, Labels, Port
from stickslip.blocks.positioner import Positioner
from stickslip.blocks.prbs import PRBS
from stickslip.blocks.product import Divide, Product
from stickslip.blocks.quantiser import Quantiser
from stickslip.blocks.quasi_static_stem import QuasiStaticStem
from stickslip.blocks.rate_limiter import RateLimiter
from stickslip.blocks.recorded import Recorded, Staircase
from stickslip.blocks.relay import Relay
from stickslip.blocks.relay_tuner import RelayTuner
from stickslip.blocks.reset_integrator import ResetIntegrator
from stickslip.blocks.resting_stem import RestingStem
from stickslip.blocks.sampled_filter import SampledFilter
from stickslip.blocks.sampled_function import SampledFunction
from stickslip.blocks.sampled_pi import SampledPI
from stickslip.blocks.sampled_pid import SampledPID
from stickslip.blocks.saturation import Saturation
from stickslip.blocks.scrubber import Scrubber
from stickslip.blocks.second_order import SecondOrder
from stickslip.blocks.select import MaxSelect, MinSelect
from stickslip.blocks.sensor import SampledSensor, Sensor
from stickslip.blocks.separator import Separator
from stickslip.blocks.shaft import Shaft
from stickslip.blocks.sources import Constant, Ramp, Step
from stickslip.blocks.state_space import StateSpace
from stickslip.blocks.stenman_valve import StenmanValve
from stickslip.blocks.stick_slip import StickSlip
from stickslip.blocks.stribeck_stem import StribeckStem
from stickslip.blocks.switch import Switch
from stickslip.blocks.tabulated_map import TabulatedMap
from stickslip.blocks.tank import Tank
from stickslip.blocks.transfer_function import TransferFunction
from stickslip.blocks.two_move import TwoMove
from stickslip.blocks.variable_delay import VariableDelay
from stickslip.blocks.zero_order_hold import ZeroOrderHold

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
    "RestingStem",
    "SampledFilter",
    "SampledFunction",
    "SampledPI",
    "SampledPID",
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
