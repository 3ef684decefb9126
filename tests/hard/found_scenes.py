"""Random scenes that failed once (`tests/tools/fuzz.py`), in fewer digits."""

from __future__ import annotations

from case import BARE, below, leaks, lines, saturated
from scenes import CARRIED, DROP

BLOWN = {  # a hundredth of the discharge port that the speed calls for, and wide blow-holes
    "gas.fluid": "Nitrogen",
    "operation.speed": "23750 rpm",
    **lines("0.8363 bar", "23 bar", "262.4 K"),
    **below("machine.volume", min="5.86 cm^3", phi_A="282.5 deg"),
    **below("machine.suction_port", area="41.75 cm^2", phi_B="64.7 deg"),
    **below("machine.discharge_port", area="0.3043 cm^2", opens="579.4 deg", phi_C="646.4 deg"),
    **below("oil_supply", ratio=1.45e-4, temperature="221.2 K"),
    **below("effects.oil_heat", droplet_radius="93.8 um", heat_transfer_coefficient="200.5 W/(m^2 K)"),
    **leaks(tip="2.51 um", interlobe="13.05 um", end_face="2.37 um", blow_hole="71.5 mm^2"),
}
HELIUM = {
    **CARRIED,
    "gas.fluid": "Helium",
    "operation.speed": "11650 rpm",
    **lines("0.38981 bar", "0.38991 bar", "340 K"),
    **below("machine.volume", min="0.0117 cm^3", phi_A="352 deg"),
    **below("machine.suction_port", area="12.7 cm^2", phi_B="59 deg"),
    **below("machine.discharge_port", area="0.2587 cm^2", opens="698.5 deg", phi_C="708.2 deg"),
    **below("oil_supply", ratio=0.0403, temperature="355 K"),
    **below("effects.oil_heat", droplet_radius="49 um", heat_transfer_coefficient="97.2 W/(m^2 K)"),
    **leaks(tip="3.2 um", interlobe="32.6 um", end_face="18.3 um", blow_hole="17.5 mm^2"),
}
OILED = ("oil_heat", "oil_pump", "hydromechanical")
STILL = {
    "oil": DROP,
    "oil_supply": DROP,
    **{f"effects.{name}": DROP for name in (*OILED, "interlobe_leakage", "end_face_leakage")},
    "gas.fluid": "SF6",
    "operation.speed": "46.39 rpm",
    **lines("1.919 bar", "1.98 bar", "329.7 K"),
    **below("machine.volume", min="0.01119 cm^3", phi_A="213.7 deg"),
    **below("machine.suction_port", area="567.3 cm^2", phi_B="5.906 deg"),
    **below("machine.discharge_port", area="280.5 cm^2", opens="407.8 deg", phi_C="415 deg"),
    **leaks(tip="3.871 um", blow_hole="10.33 mm^2"),
}
FAINT = {
    **below("effects", tip_leakage=DROP, blow_hole=DROP),
    "gas.fluid": "Helium",
    "operation.speed": "19.45 rpm",
    **lines("2.216649 bar", "2.217224 bar", "373.3 K"),
    **below("machine.volume", min="2.972e-05 cm^3", phi_A="101.1 deg"),
    **below("machine.suction_port", area="0.4771 cm^2", phi_B="82.16 deg"),
    **below("machine.discharge_port", area="291.2 cm^2", opens="579.2 deg", phi_C="648.4 deg"),
    **below("oil_supply", ratio=0.0124, temperature="410.3 K"),
    **below("effects.oil_heat", droplet_radius="533.6 um", heat_transfer_coefficient="92.26 W/(m^2 K)"),
    **leaks(interlobe="251.4 um", end_face="15.27 um"),
    "numerics.closing": "coupled",
}
DRENCHED = {
    **CARRIED,
    "gas.fluid": "n-Dodecane",
    "operation.speed": "199.1 rpm",
    **lines("2.916704 bar", "3.028468 bar", "285 K"),
    **below("machine.volume", min="1.977e-06 cm^3", phi_A="239.9 deg"),
    **below("machine.suction_port", area="399.7 cm^2", phi_B="22.24 deg"),
    **below("machine.discharge_port", area="1.616 cm^2", opens="654.5 deg", phi_C="685.7 deg"),
    **below("oil_supply", ratio=25.2, temperature="278.9 K"),
    **below("effects.oil_heat", droplet_radius="4.595 um", heat_transfer_coefficient="201.4 W/(m^2 K)"),
    **leaks(tip="282.2 um", interlobe="93.86 um", end_face="1.121 um", blow_hole="78.51 mm^2"),
    "numerics.closing": "coupled",
}
THROTTLED = {
    **below("gas", model="real", two_phase="equilibrium"),
    **saturated("264 K", "312 K", superheat="27 K"),
    "operation.speed": "7200 rpm",
    **below("oil_supply", ratio=1, temperature="307 K"),
    "effects.oil_heat.droplet_radius": "0.3 um",
    **below("machine.suction_port", area="4.8 cm^2", phi_B="172 deg"),
    "machine.volume.min": "21 cm^3",
}
STARVED = {
    **BARE,
    "gas.fluid": "SF6",
    "operation.speed": "890.55 rpm",
    **lines("7.7347 bar", "162.19 bar", "317.875 K"),
    **below("machine.volume", min="0.0161974 cm^3", phi_A="103.68 deg"),
    **below("machine.suction_port", area="0.765429 cm^2", phi_B="175.093 deg"),
    **below("machine.discharge_port", area="55.2703 cm^2", opens="491.667 deg", phi_C="601.5215 deg"),
}
FLOODED = {
    **CARRIED,
    "gas.fluid": "Ammonia",
    "operation.speed": "14 rpm",
    **lines("1.24 bar", "17.5 bar", "302 K"),
    "oil_supply.ratio": 9,
    **leaks(tip="670 um", interlobe="164 um"),
}
SLOW_TO_HEAT = {  # scene 1480 of seed 1
    **BARE,
    "gas.fluid": "R134a",
    **lines("0.498144 bar", "23.04197 bar", "305.01 K"),
    "operation.speed": "21413 rpm",
    **below("machine.volume", min="0.0015691 cm^3", phi_A="37.236 deg"),
    **below("machine.suction_port", area="6.5334 cm^2", phi_B="48.179 deg"),
    **below("machine.discharge_port", area="20.711 cm^2", opens="421.33 deg", phi_C="496.93 deg"),
}
LEAPT_OVER = {  # scene 840 of seed 1
    **BARE,
    "gas.fluid": "Hydrogen",
    **lines("2.643991 bar", "3.127113 bar", "278.45 K"),
    "operation.speed": "26359 rpm",
    **below("machine.volume", min="0.0078054 cm^3", phi_A="348.5 deg"),
    **below("machine.suction_port", area="3322.2 cm^2", phi_B="136.98 deg"),
    **below("machine.discharge_port", area="0.14596 cm^2", opens="602.46 deg", phi_C="634.31 deg"),
    "numerics.accuracy": 4.2229e-05,
}
SHUT_IN = {  # scene 5040 of seed 1
    **BARE,
    **below("gas", fluid="Helium", isentropic_exponent=1.38027),
    **lines("0.26964 bar", "0.31665 bar", "272.35 K"),
    "operation.speed": "699.2 rpm",
    **below("machine.volume", min="0.016743 cm^3", phi_A="295.7 deg"),
    **below("machine.suction_port", area="1609.5 cm^2", phi_B="164.88 deg"),
    **below("machine.discharge_port", area="0.37252 cm^2", opens="632.65 deg", phi_C="662.12 deg"),
    "numerics.accuracy": 1.3459e-04,
}
HOT = {  # scene 664 of seed 1
    **CARRIED,
    "gas.fluid": "Helium",
    **lines("5.786145 bar", "6.105882 bar", "251.23 K"),
    **leaks(tip="28.892 um", interlobe="894.36 um", end_face="3.2966 um", blow_hole="4.0205 mm^2"),
    **below("effects.oil_heat", droplet_radius="2.3116 um", heat_transfer_coefficient="149.18 W/(m^2 K)"),
    "effects.oil_pump": DROP,
    "operation.speed": "24063 rpm",
    **below("machine.volume", min="0.0004433 cm^3", phi_A="17.837 deg"),
    **below("machine.suction_port", area="6.0375 cm^2", phi_B="107.58 deg"),
    **below("machine.discharge_port", area="0.12092 cm^2", opens="522.07 deg", phi_C="565.76 deg"),
    **below("oil_supply", temperature="223.01 K", ratio=0.16005),
}
WET_AND_LEAKY = {  # scene 2344 of seed 1
    **below("gas", model="real", two_phase="equilibrium", fluid="R134a"),
    **saturated("266.43 K", "321.32 K", superheat="12.427 K"),
    **leaks(tip="3.1671 um", interlobe="20.385 um", end_face="30.267 um", blow_hole="4.8158 mm^2"),
    **below("effects.oil_heat", droplet_radius="0.65824 um", heat_transfer_coefficient="3710.1 W/(m^2 K)"),
    "effects.mechanical": DROP,
    "operation.speed": "2084.9 rpm",
    **below("machine.volume", min="9.227e-05 cm^3", phi_A="168.42 deg"),
    **below("machine.suction_port", area="17.152 cm^2", phi_B="162.94 deg"),
    **below("machine.discharge_port", area="34.179 cm^2", opens="499.71 deg", phi_C="554.15 deg"),
    **below("oil_supply", temperature="319.47 K", ratio=0.79548),
}
SWINGING = {  # scene 23 of seed 1
    **below("effects", tip_leakage=DROP, blow_hole=DROP),
    "gas.fluid": "Nitrogen",
    **lines("1.59052 bar", "1.590723 bar", "295.89 K"),
    **leaks(interlobe="80.547 um", end_face="70.208 um"),
    **below("effects.oil_heat", droplet_radius="723.29 um", heat_transfer_coefficient="52.233 W/(m^2 K)"),
    "effects.oil_pump": DROP,
    "operation.speed": "3511.1 rpm",
    **below("machine.volume", min="3.3808e-05 cm^3", phi_A="53.731 deg"),
    **below("machine.suction_port", area="127.68 cm^2", phi_B="89.043 deg"),
    **below("machine.discharge_port", area="0.20861 cm^2", opens="460.09 deg", phi_C="585.66 deg"),
    **below("oil_supply", temperature="335.63 K", ratio=0.058407),
}
BETWEEN = {  # scene 2604 of seed 1
    **below("effects", tip_leakage=DROP, blow_hole=DROP),
    "gas.fluid": "R134a",
    **saturated("282.89 K", "296.88 K", superheat="21.301 K"),
    **leaks(interlobe="5.4534 um", end_face="33.477 um"),
    **below("effects.oil_heat", droplet_radius="160.55 um", heat_transfer_coefficient="979.03 W/(m^2 K)"),
    **below("effects", hydromechanical=DROP, mechanical=DROP),
    "operation.speed": "12.855 rpm",
    **below("machine.volume", min="0.00010645 cm^3", phi_A="84.372 deg"),
    **below("machine.suction_port", area="1467.6 cm^2", phi_B="173.43 deg"),
    **below("machine.discharge_port", area="13.713 cm^2", opens="494.69 deg", phi_C="544.4 deg"),
    "numerics.accuracy": 7.7465e-4,
    **below("oil_supply", temperature="330.87 K", ratio=26.982),
}
COLD_OIL = {  # scene 670 of seed 1
    **CARRIED,
    "gas.fluid": "Ammonia",
    **saturated("243.88 K", "317.51 K", superheat="58.64 K"),
    **leaks(tip="671.31 um", interlobe="163.69 um", end_face="4.0379 um", blow_hole="0.22741 mm^2"),
    **below("effects.oil_heat", droplet_radius="13.371 um", heat_transfer_coefficient="2000.9 W/(m^2 K)"),
    "operation.speed": "13.868 rpm",
    **below("machine.volume", min="9.4899e-05 cm^3", phi_A="56.946 deg"),
    **below("machine.suction_port", area="149.88 cm^2", phi_B="102.74 deg"),
    **below("machine.discharge_port", area="33.777 cm^2", opens="569.7 deg", phi_C="608.01 deg"),
    **below("oil_supply", temperature="211.38 K", ratio=8.9892),
}
NO_OUTFLOW = {  # scene 14548 of seed 1
    **BARE,
    "gas.fluid": "Helium",
    **lines("0.80487433 bar", "14.84101479 bar", "328.74159 K"),
    "operation.speed": "11442.962 rpm",
    **below("machine.volume", min="39.854615 cm^3", phi_A="104.18416 deg"),
    **below("machine.suction_port", area="0.40621007 cm^2", phi_B="166.93424 deg"),
    **below("machine.discharge_port", area="0.12443405 cm^2", opens="553.59891 deg", phi_C="559.372426 deg"),
}
FILLED_WITH_LIQUID = {  # scene 10851 of seed 1
    **below("gas", model="real", two_phase="equilibrium", fluid="R134a"),
    "operation.suction": {"pressure": "1.8195784 bar", "superheat": "15.561296 K"},
    "operation.discharge": {"pressure": "2.236741378 bar"},
    **leaks(tip="5.2813542 um", interlobe="237.0777 um", end_face="104.00592 um", blow_hole="0.1497563 mm^2"),
    **below("effects.oil_heat", droplet_radius="0.52186277 um", heat_transfer_coefficient="63.25318 W/(m^2 K)"),
    **below("effects", oil_pump=DROP, mechanical=DROP),
    "operation.speed": "3544.176 rpm",
    **below("machine.volume", min="1.6671403 cm^3", phi_A="134.87178 deg"),
    **below("machine.suction_port", area="4.7771989 cm^2", phi_B="172.58584 deg"),
    **below("machine.discharge_port", area="3.3164077 cm^2", opens="669.22621 deg", phi_C="680.3494135 deg"),
    **below("oil_supply", temperature="263.72358 K", ratio=32.74960855),
}
