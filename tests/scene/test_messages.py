"""Rules of faults: each is one line with file, line, column, path, what and the remedy; all come at once."""

import time
from pathlib import Path

import pytest
from each_row import each_row

from screwsim.inputs.faults import SceneError, UsageError
from screwsim.scene import load, loads


def faults_of(text, **options):
    with pytest.raises(SceneError) as error:
        loads(text, "x.yaml", **options)
    return error.value.lines


TYPICAL = [
    # (text in the example, what a person wrote instead, the message)
    ("160 mm", "abc", "x.yaml:6:19: machine.rotor_diameter: 'abc' is not a length (write e.g. '128 mm')"),
    ("160 mm", "160", "x.yaml:6:19: machine.rotor_diameter: 160 has no unit (write e.g. '128 mm')"),
    ("160 mm", "0", "x.yaml:6:19: machine.rotor_diameter: 0 has no unit (write e.g. '128 mm')"),
    ("160 mm", "true", "x.yaml:6:19: machine.rotor_diameter: true is not a length (write e.g. '128 mm')"),
    ("160 mm", "[1]", "x.yaml:6:19: machine.rotor_diameter: a list is not a length (write e.g. '128 mm')"),
    (
        "160 mm",
        "-3 mm",
        "x.yaml:6:19: machine.rotor_diameter: '-3 mm' is out of range (it must be greater than 0 mm)",
    ),
    (
        "  rotor_diameter: 160 mm\n",
        "",
        "x.yaml:2:1: machine.rotor_diameter: is missing (write rotor_diameter: … mm; outer diameter of the male rotor)",
    ),
    ("male_lobes: 4", "male_lobes: 4.5", "x.yaml:4:15: machine.male_lobes: 4.5 is not a whole number (write e.g. 4)"),
    (
        "male_lobes: 4",
        "male_lobes: 40",
        "x.yaml:4:15: machine.male_lobes: 40 is out of range (it must be at least 1 and at most 12)",
    ),
    (
        "male_lobes: 4",
        "male_lobs: 4",
        "x.yaml:4:3: machine.male_lobs: is not known; did you mean 'male_lobes'?",
    ),
    ("ratio: 3", 'ratio: "3"', "x.yaml:28:10: oil_supply.ratio: '3' is text, not a number (write 3 without quotes)"),
    ("ratio: 3", "ratio: true", "x.yaml:28:10: oil_supply.ratio: true is not a number (write e.g. 0.5)"),
    ("ratio: 3", "ratio: .nan", "x.yaml:28:10: oil_supply.ratio: nan is not a finite number (write e.g. 0.5)"),
    (
        "ratio: 3",
        "ratio: 3 kg",
        "x.yaml:28:10: oil_supply.ratio: '3 kg' is not a plain number (write e.g. 0.5, without a unit)",
    ),
    (
        "kind: pump",
        "kind: pmp",
        "x.yaml:27:9: oil_supply.kind: 'pmp' is not an option; did you mean 'pump'? (choose from: pump, displacement)",
    ),
    (
        "model: ideal",
        "model: rael",
        "x.yaml:13:10: gas.model: 'rael' is not an option; did you mean 'real'? (choose from: ideal, real)",
    ),
    (
        "fluid: R134a",
        "fluid: {fluid: [R32, R125], mass_fractions: [0.5, 0.5]}",
        "x.yaml:12:10: gas.fluid: a mapping is not a fluid outside a sweep (write fluid: NAME, or for a blend fluid: "
        "[NAME, NAME] and mass_fractions)",
    ),
    ("title: example", "title: 5", "x.yaml:1:8: title: 5 is not text (write it in quotes)"),
    (
        "blow_hole: {area: 6 mm^2}",
        "blow_hole:",
        "x.yaml:35:3: effects.blow_hole.area: is missing (write e.g. area: 6 mm^2; area of one blow-hole)",
    ),
    ("blow_hole:", "blowhole:", "x.yaml:35:3: effects.blowhole: is not known; did you mean 'blow_hole'?"),
    (
        "transport: paper",
        "transport: paper\n  transport: carried",
        "x.yaml:19:3: oil.transport: appears twice, first in line 18 (remove one)",
    ),
    (
        "title: example",
        "<<: {title: a}",
        "x.yaml:1:1: <<: merge keys are not supported (write the keys out, or use base:)",
    ),
    (
        "1.5 bar",
        "0.5 BARG",
        "x.yaml:22:15: operation.suction.pressure: '0.5 BARG' is a gauge pressure "
        "(write the absolute pressure, e.g. '2 bar')",
    ),
    (
        "12 bar",
        "1 bar",
        "x.yaml:25:15: operation.discharge.pressure: 1 bar is below the suction pressure 1.5 bar "
        "(raise it, or write machine.mode: expander)",
    ),
    (
        "12 bar",
        "1.5 bar",
        "x.yaml:25:15: operation.discharge.pressure: 1.5 bar equals the suction pressure "
        "(nothing is compressed; choose another)",
    ),
    (
        "male_lobes: 4",
        "mode: expander",
        "x.yaml:25:15: operation.discharge.pressure: 12 bar is above the suction pressure 1.5 bar "
        "(lower it, or write machine.mode: compressor)",
    ),
    (
        "    temperature: 283 K\n",
        "",
        "x.yaml:21:3: operation.suction.temperature: is missing (give temperature or superheat)",
    ),
    (
        "temperature: 283 K",
        "temperature: 283 K\n    superheat: 5 K",
        "x.yaml:24:16: operation.suction.superheat: is given as well as temperature (remove one of the two)",
    ),
    (
        "opens: 600 deg",
        "opens: 800 deg",
        "x.yaml:10:54: machine.discharge_port.opens: 800 deg lies outside (360 deg, 720 deg); choose an angle inside",
    ),
    ("  ratio: 3\n", "", "x.yaml:26:1: oil_supply.ratio: is missing (kind: pump needs it, e.g. ratio: 3)"),
    (
        "ratio: 3",
        "ratio: 3\n  orifice_diameter: 3 mm",
        "x.yaml:29:21: oil_supply.orifice_diameter: applies only to kind: displacement (remove it, or change the kind)",
    ),
]


LINE = "(write NAME: value, with a space after the colon and indented like its neighbours; also check the line above)"
BLOW_HOLE = "flow_coefficient, area_file, area, opens, closes, suction_area, suction_closes, model"
UNDER = f"under it: {BLOW_HOLE}; or blow_hole: off to leave it out)"
NEWCOMERS = [
    # ---- YAML ----
    (
        "  kind: twin_screw",
        "\tkind: twin_screw",
        "x.yaml:3:1: is not YAML: found character '\\t' that cannot start any token "
        "(line 3 has a tab: replace it by spaces)",
    ),
    (
        "  fluid: R134a",
        "\u00a0 fluid: R134a",
        "x.yaml:13:8: is not YAML: mapping values are not allowed here "
        "(line 12 has a no-break space: replace it by spaces)",
    ),
    (
        "kind: twin_screw",
        "kind twin_screw",
        f"x.yaml:4:13: is not YAML: mapping values are not allowed here {LINE}",
    ),
    ("male_lobes: 4", "male_lobes = 4", f"x.yaml:5:3: is not YAML: could not find expected ':' {LINE}"),
    (
        "title: example",
        'title: "example',
        "x.yaml:43:1: is not YAML: found unexpected end of stream (close the quote that opens in line 1, column 8)",
    ),
    (
        "{gap: 50 um}",
        "{gap: 50 um",
        "x.yaml:34:20: is not YAML: expected ',' or '}', but got ':' "
        "(close the { that opens in line 33, column 16 with }, and separate what is inside by commas)",
    ),
    (
        "  model: ideal",
        "    model: ideal",
        f"x.yaml:13:10: is not YAML: mapping values are not allowed here {LINE}",
    ),
    (
        "gas:",
        "---\ngas:",
        "x.yaml:11:1: is not YAML: but found another document "
        "(a scene is one document: remove the line with --- or ... and all that follows it)",
    ),
    (
        "title: example",
        "[scene]\ntitle = example",
        "x.yaml:2:1: is not YAML: expected '<document start>', but found ('<scalar>',) "
        "(a scene consists of lines NAME: value only)",
    ),
    (
        "title: example",
        "title: !!python/name:os.system x",
        "x.yaml:1:8: title: has the tag !!python/name:os.system, which a scene cannot have (remove it)",
    ),
    # ---- names and places ----
    ("title: example", "speed: 3000 rpm", "x.yaml:1:1: speed: is not known; did you mean 'operation.speed'?"),
    (
        "title: example",
        "operation.speed: 3000 rpm",
        "x.yaml:1:1: operation.speed: is a path, which only --set and sweep take (here write speed under operation)",
    ),
    ("title: example", "mechanical: {}", "x.yaml:1:1: mechanical: is not known; did you mean 'effects.mechanical'?"),
    (
        "title: example",
        "suction_port: {}",
        "x.yaml:1:1: suction_port: is not known; there are machine.suction_port, effects.suction_port "
        "(write the whole path)",
    ),
    ("model: ideal", "name: R134a", "x.yaml:13:3: gas.name: is not known; did you mean 'fluid'?"),
    ("model: ideal", "refrigerant: R134a", "x.yaml:13:3: gas.refrigerant: is not known; did you mean 'fluid'?"),
    ("title: example", "refrigerant: R134a", "x.yaml:1:1: refrigerant: is not known; did you mean 'gas.fluid'?"),
    ("model: ideal", "ratio: 3", "x.yaml:13:3: gas.ratio: is not known; did you mean 'oil_supply.ratio'?"),
    ("oil_supply:", "oil-supply:", "x.yaml:26:1: oil-supply: is not known; did you mean 'oil_supply'?"),
    (
        "male_lobes: 4",
        "lobes: 4",
        "x.yaml:4:3: machine.lobes: is not known; there are male_lobes, female_lobes (write the whole name)",
    ),
    (
        "kind: twin_screw",
        "kind: twin-screw",
        "x.yaml:3:9: machine.kind: 'twin-screw' is not an option; did you mean 'twin_screw'? "
        "(choose from: twin_screw, slider_crank)",
    ),
    (
        "kind: twin_screw",
        "kind: reciprocating",
        "x.yaml:3:9: machine.kind: 'reciprocating' is not an option; did you mean 'slider_crank'? "
        "(choose from: twin_screw, slider_crank)",
    ),
    (
        "model: ideal",
        "model: covolume",
        "x.yaml:13:10: gas.model: 'covolume' is not an option (choose from: ideal, real, or the dotted name of a "
        "module of your own)",
    ),
    (
        "model: ideal",
        "model: ideal gas",
        "x.yaml:13:10: gas.model: 'ideal gas' is not an option; did you mean 'ideal'? (choose from: ideal, real)",
    ),
    (  # and nothing is said of its parts, which may be right for another kind
        "kind: twin_screw",
        "kind: scroll\n  bore: 50 mm",
        "x.yaml:3:9: machine.kind: 'scroll' is not an option (choose from: twin_screw, slider_crank)",
    ),
    (
        "title: example",
        "base: nix.yaml\nspeed: 3",
        "x.yaml:1:7: base: 'nix.yaml' does not exist "
        f"(name a scene file as seen from the folder of this one, {Path.cwd()})",
    ),
    # ---- values ----
    (
        "3000 rpm",
        "50 Hz",
        "x.yaml:20:10: operation.speed: '50 Hz' is ambiguous: turns or radians (write rpm, rev/s or rad/s, e.g. '3000 "
        "rpm')",
    ),
    (
        "3000 rpm",
        "3,000 rpm",
        "x.yaml:20:10: operation.speed: '3,000 rpm' has a comma that may separate thousands or decimals "
        "(write '3000 rpm', or '3 rpm' if decimals are meant)",
    ),
    ("3000 rpm", "“3000 rpm”", "x.yaml:20:10: operation.speed: '“3000 rpm”' has typographic quotes (write '3000 rpm')"),
    ("283 K", "10", "x.yaml:23:18: operation.suction.temperature: 10 has no unit (write e.g. '285 K')"),
    (
        "283 K",
        "- 10 C",
        "x.yaml:23:18: is not YAML: sequence entries are not allowed here "
        "(a list begins on its own line, or is in [ ]; a minus sign has no space after it)",
    ),
    (
        "1.5 bar",
        "1,5 bar",
        "x.yaml:22:15: operation.suction.pressure: '1,5 bar' has a decimal comma (write a point, e.g. '1.5 bar')",
    ),
    ("12 bar", "1200", "x.yaml:25:15: operation.discharge.pressure: 1200 has no unit (write e.g. '2 bar')"),
    (
        "20 mPa s",
        "20 cSt",
        "x.yaml:17:14: oil.viscosity: '20 cSt' is a kinematic viscosity "
        "(multiply it by the density; write e.g. '20 mPa s')",
    ),
    (
        "2 kJ/(kg K)",
        "2 kJ/kgK",
        "x.yaml:16:18: oil.heat_capacity: '2 kJ/kgK' is not a heat capacity (write '2 kJ/(kg K)')",
    ),
    ("ratio: 3", "ratio: 3,5", "x.yaml:28:10: oil_supply.ratio: '3,5' has a decimal comma (write a point, e.g. 3.5)"),
    ("ratio: 3", "ratio: 50 %", "x.yaml:28:10: oil_supply.ratio: '50 %' is a share (write 0.5)"),
    (
        "efficiency: 0.6",
        "efficiency: 60",
        "x.yaml:40:26: effects.oil_pump.efficiency: 60 is out of range "
        "(it must be greater than 0 and at most 1; 60 % is 0.6)",
    ),
    (
        "male_lobes: 4",
        'male_lobes: "4"',
        "x.yaml:4:15: machine.male_lobes: '4' is text, not a number (write 4 without quotes)",
    ),
    (
        "male_lobes: 4",
        "male_lobes: 4.0",
        "x.yaml:4:15: machine.male_lobes: 4.0 is not written as a whole number (write 4)",
    ),
    # ---- effects ----
    (
        "{area: 6 mm^2}",
        "yes",
        f"x.yaml:35:14: effects.blow_hole: 'yes' is neither parameters nor off "
        f"(write blow_hole: alone, or with parameters {UNDER}",
    ),
    (
        "{area: 6 mm^2}",
        "6 mm^2",
        f"x.yaml:35:14: effects.blow_hole: '6 mm^2' is neither parameters nor off "
        f"(write blow_hole: alone, or with parameters {UNDER}",
    ),
    (
        "{area: 6 mm^2}",
        "{gap: 6 um, area: 6 mm^2}",
        f"x.yaml:35:15: effects.blow_hole.gap: is not known; known here: {BLOW_HOLE}",
    ),
    # ---- sweeps ----
    (
        "title: example",
        "sweep: {operation.speed: 3000 rpm}",
        "x.yaml:1:26: sweep.operation.speed: '3000 rpm' is neither a list "
        "nor {from, to, count} (write e.g. [3000 rpm])",
    ),
    (
        "title: example",
        "sweep: {speed: [3000 rpm]}",
        "x.yaml:1:9: sweep.speed: is not known; did you mean 'operation.speed'?",
    ),
    (
        "title: example",
        "sweep: {oil_supply.ratio: [0,5, 1,5]}",
        "x.yaml:1:27: sweep.oil_supply.ratio: has 5 twice (remove one, or write decimals with a point)",
    ),
    (
        "title: example",
        "sweep: {operation.speed: [1000 rpm, , 2 rpm]}",
        "x.yaml:1:37: is not YAML: expected the node "
        "content, but found ',' (a value is missing here: write it, or remove the comma)",
    ),
    (
        "title: example",
        "sweep: off",
        "x.yaml:1:8: sweep: 'off' is not a mapping "
        "(write null to leave it out, or e.g. operation.speed: [1000 rpm, 2000 rpm])",
    ),
    (
        "title: example",
        "sweep: {gas.mass_fractions: [0.3, 0.7]}",
        "x.yaml:1:9: sweep.gas.mass_fractions: cannot be varied (only quantities, numbers, choices and the fluid can)",
    ),
    # ---- other files ----
    (
        "title: example",
        "stages: [a.yaml, b.yaml]",
        "x.yaml:1:1: describes two stages, which only `screwsim run`, `sweep`, `datasheet`, `optimum`, `optimize`, "
        "`find`, `sensitivity`, `explain` and `export` accept (run one of these on x.yaml, or name the scene of one "
        "stage here)",
    ),
]


@each_row(("old", "new", "line"), [*TYPICAL, *NEWCOMERS])
def test_a_typical_or_a_newcomers_mistake_gives_its_one_line(example, old, new, line):
    assert old in example
    assert faults_of(example.replace(old, new, 1)) == [line]


def test_a_decimal_comma_in_brackets_is_told_beside_what_it_makes(example):
    assert faults_of(example.replace("600 cm^3", "600,5 cm^3")) == [
        "x.yaml:8:29: machine.volume.max: 600 has no unit (write e.g. '500 cm^3')",
        "x.yaml:8:33: machine.volume.5 cm^3: is not a name (in { } and [ ] a comma begins another entry; write "
        "decimals with a point)",
    ]


@pytest.mark.parametrize("word", ["off", "no", "No", "false", "FALSE"])
def test_off_no_and_false_leave_an_effect_out(example, word):
    assert "blow_hole" not in loads(example.replace("{area: 6 mm^2}", word)).effects
    assert "blow_hole" not in loads(example, overrides=[f"effects.blow_hole={word}"]).effects


@each_row(
    ("override", "line"),
    [
        ("speed=3000 rpm", "speed: is not known; did you mean 'operation.speed'?"),
        ("gas.name=R290", "gas.name: is not known; did you mean 'fluid'?"),
        ("oil.fluid=POE_68", "oil.fluid: is not known; did you mean 'name'?"),
        (
            "gap=5 um",
            "gap: is not known; there are effects.tip_leakage.gap, effects.interlobe_leakage.gap, "
            "effects.end_face_leakage.gap (write the whole path)",
        ),
        (
            "operation=3000 rpm",
            "operation: '3000 rpm' is not a mapping (write lines NAME: value; known: speed, tip_speed, "
            "ambient_temperature, ambient_pressure, suction, discharge, evaporating_temperature, "
            "condensing_temperature, superheat, subcooling, aftercooler_temperature, gas_cooler)",
        ),
        ("effects={}", "effects: {} changes nothing, as it is merged into what is there (write null to remove that)"),
        (
            "effects.blow_hole={}",
            "effects.blow_hole: {} changes nothing, as it is merged into what is there (write off to remove that)",
        ),
        (
            "oil=off",
            "oil: 'off' is not a mapping (write null to leave it out, or lines NAME: value; known: name, density, "
            "heat_capacity, viscosity, transport)",
        ),
        (
            "operation.speed=",
            "operation.speed: is missing (write speed: … rpm; speed of the male rotor, or of the crank)",
        ),
        (
            'operation.speed="3000 rpm',
            "operation.speed: is not YAML: found unexpected end of stream "
            "(close the quote that opens in line 1, column 1)",
        ),
        (
            "sweep.operation.speed=3000 rpm",
            "sweep.operation.speed: '3000 rpm' is neither a list nor {from, to, count} (write e.g. [3000 rpm])",
        ),
        (
            "sweep.operation.speed=1000 rpm..3000 rpm",
            "sweep.operation.speed: '1000 rpm..3000 rpm' is neither a list nor {from, to, count} "
            "(write {from: 1000 rpm, to: 3000 rpm, count: …})",
        ),
        (
            "sweep.oil_supply.ratio=0.5 .. 3, 6",
            "sweep.oil_supply.ratio: '0.5 .. 3, 6' is neither a list nor {from, to, count} "
            "(write {from: 0.5, to: 3, count: 6})",
        ),
        (
            "operation.suction.temperature=- 10 C",
            "operation.suction.temperature: '- 10 C' has a space after its sign (write '-10 C')",
        ),
    ],
)
def test_a_mistaken_override_gives_its_one_line(example, override, line):
    assert faults_of(example, overrides=[override]) == [f"--set {override}: {line}"]


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("effects.blow_hole", "that effect is not active in this scene; did you mean 'blow_hole'? (active: "),
        ("blow_hole,tip_leakage", "takes one effect at a time (write --without blow_hole --without tip_leakage)"),
        ("all", "that effect is not active in this scene (active: suction_port, "),
    ],
)
def test_a_mistaken_without_gives_its_one_line(example, name, told):
    with pytest.raises(UsageError) as error:
        loads(example, without=[name])
    assert str(error.value).startswith(f"--without {name}: {told}")


@pytest.mark.parametrize(
    "change", [("\n", "\r\n"), ("50 um", "50\u00a0um"), ("50 um", '"50 um"'), ("speed:", '"speed":')]
)
def test_what_editors_write_is_no_fault(example, change):
    assert loads(example.replace(*change), "x.yaml").operation == loads(example).operation


def test_bytes_of_windows_are_told_where_they_stand(tmp_path, monkeypatch, example):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.yaml").write_bytes(example.replace("50 um", "50 µm").encode("cp1252"))
    with pytest.raises(SceneError) as error:
        load("x.yaml")
    assert error.value.lines == [
        "x.yaml:33:25: cannot be read: it is not UTF-8 text (name an existing scene file, saved as UTF-8)"
    ]


def test_a_word_of_yaml_1_1_is_a_word(example):
    lines = faults_of(example.replace("transport: paper", "transport: no"))
    assert lines == ["x.yaml:18:14: oil.transport: 'no' is not an option (choose from: paper, carried)"]


def test_a_misspelt_required_name_is_both_unknown_and_missing(example):
    lines = faults_of(example.replace("rotor_length:", "rotor_lenght:"))
    assert lines == [
        "x.yaml:2:1: machine.rotor_length: is missing (write rotor_length: … mm; length of the rotors)",
        "x.yaml:7:3: machine.rotor_lenght: is not known; did you mean 'rotor_length'?",
    ]


def test_an_unknown_name_far_from_all_lists_the_known_ones(example):
    lines = faults_of(example.replace("{gap: 50 um}", "{gap: 50 um, xyz: 1}"))
    assert lines == [
        "x.yaml:33:29: effects.tip_leakage.xyz: is not known; known here: flow_coefficient, area_file, gap, "
        "model, passage, friction_fit, mixture_viscosity, mixture_friction, filled_from, wall_speed, gas_viscosity, "
        "reading"
    ]


def test_every_fault_comes_at_once_in_the_order_of_the_file(example):
    text = example.replace("160 mm", "160").replace("3000 rpm", "50 Hz").replace("area: 6 mm^2", "area: 6 mm")
    text = text.replace("title: example", "title: example\nsweep: {oil_supply.ratio: [-1]}")
    assert [line.split(": ")[0] for line in faults_of(text)] == [
        "x.yaml:2:28",
        "x.yaml:7:19",
        "x.yaml:21:10",
        "x.yaml:36:21",
    ]


def test_every_cross_check_comes_at_once(example):
    text = example.replace("12 bar", "1 bar").replace("phi_A: 60 deg", "phi_A: 0 deg").replace("  ratio: 3\n", "")
    assert [line.split(": ")[1] for line in faults_of(text)] == [
        "machine.volume.phi_A",
        "operation.discharge.pressure",
        "oil_supply.ratio",
    ]


def test_an_effect_that_needs_oil_names_what_is_absent(example):
    oil, operation = example.index("oil:"), example.index("operation:")
    supply, effects = example.index("oil_supply:"), example.index("effects:")
    dry = example[:oil] + example[operation:supply] + example[effects:]
    text = dry.replace("  oil_pump: {efficiency: 0.6}\n  hydromechanical:\n", "")
    assert faults_of(text) == [
        "x.yaml:28:3: effects.oil_heat: needs oil and oil_supply, which this scene lacks (write that, or remove the "
        "effect)"
    ]


def test_displacement_demands_orifice_and_viscosity_and_refuses_ratio_and_pump(example):
    text = example.replace("kind: pump", "kind: displacement\n  source: suction").replace("  viscosity: 20 mPa s\n", "")
    assert [": ".join(line.split(": ")[:2]) for line in faults_of(text)] == [
        "x.yaml:14:1: oil.viscosity",
        "x.yaml:25:1: oil_supply.orifice_diameter",
        "x.yaml:27:11: oil_supply.source",
        "x.yaml:28:10: oil_supply.ratio",
        "x.yaml:40:3: effects.oil_pump",
    ]


def test_a_bore_so_long_that_no_formula_holds_is_refused(example):
    lengths = "kind: displacement\n  orifice_diameter: 2 mm\n  orifice_length: LONG"
    text = example.replace("kind: pump", lengths).replace("  ratio: 3\n", "")
    told = [line for line in faults_of(text.replace("LONG", "20 cm")) if "orifice_length" in line]
    assert told == [
        "x.yaml:29:19: oil_supply.orifice_length: is 100 diameters: no formula covers so long a bore "
        "(choose 2 to 10 diameters)"
    ]
    assert not [line for line in faults_of(text.replace("LONG", "2 cm")) if "orifice_length" in line]


def test_an_effect_of_a_port_demands_its_section(example):
    text = "\n".join(line for line in example.splitlines() if not line.startswith("  suction_port: {"))
    assert faults_of(text) == [
        "x.yaml:30:3: effects.suction_port: needs the section machine.suction_port (write it, or remove the effect)"
    ]


@each_row(
    ("text", "line"),
    [
        ("", "x.yaml:1:1: is empty (write at least machine, gas, operation)"),
        ("# nothing\n", "x.yaml:1:1: is empty (write at least machine, gas, operation)"),
        ("- a\n", "x.yaml:1:1: is a list, not a mapping (write lines such as machine: …)"),
        ("word", "x.yaml:1:1: is 'word', not a mapping (write lines such as machine: …)"),
        (
            "a: [1,\nb: 2",
            "x.yaml:2:5: is not YAML: expected ',' or ']', but got '<stream end>' "
            "(close the [ that opens in line 1, column 4 with ], and separate what is inside by commas)",
        ),
        (
            "machine:\n\tkind: x",
            "x.yaml:2:1: is not YAML: found character '\\t' that cannot start any token "
            "(line 2 has a tab: replace it by spaces)",
        ),
        (
            "a: *b",
            "x.yaml:1:4: is not YAML: found undefined alias 'b' "
            "(write the value out, or quote a text that begins with *)",
        ),
    ],
)
def test_a_file_that_is_no_scene_gives_one_line(text, line):
    assert faults_of(text) == [line]


def test_a_control_character_is_told_where_it_stands():
    assert faults_of("title: a\nmachine: \x07b") == [
        "x.yaml:2:10: is not YAML: it contains the control character U+0007 "
        "(remove it, or save the file as plain text in UTF-8)"
    ]


def test_a_number_is_one_of_yaml_1_2(example):
    assert loads(example, overrides=["oil_supply.ratio=.3e1"]).oil_supply.ratio == 3.0
    with pytest.raises(SceneError, match="'3_0' is not one number"):
        loads(example, overrides=["oil_supply.ratio=3_0"])


def test_an_endless_number_is_told_at_once(example):
    began = time.process_time()
    (line,) = faults_of(example.replace("speed: 3000 rpm", f"speed: {'9' * 20_000} rpm"))
    assert "is not finite" in line
    assert time.process_time() - began < 2.0  # a pattern that goes to and fro over the digits takes half a minute


def test_an_alias_inside_its_own_anchor_is_refused(example):
    lines = faults_of(example.replace("title: example", "title: &a [*a]"))
    assert "x.yaml:1:8: title: contains itself (write the values out instead of the alias)" in lines


def test_a_fault_stays_on_one_line(example):
    (line,) = faults_of(example.replace("title: example", '"a\\nb\\e": 1'))
    assert line.startswith("x.yaml:1:1: a b : is not known")


@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda path: None, "No such file or directory"),
        (lambda path: path.mkdir(), "it is a folder"),
        (lambda path: path.write_bytes(b"\xff\xfe"), "it is not UTF-8 text"),
    ],
    ids=["missing", "folder", "binary"],
)
def test_an_unreadable_file_gives_one_line(tmp_path, monkeypatch, make, what):
    monkeypatch.chdir(tmp_path)
    make(tmp_path / "x.yaml")
    with pytest.raises(SceneError) as error:
        load("x.yaml")
    expected = f"x.yaml:1:1: cannot be read: {what} (name an existing scene file, saved as UTF-8)"
    assert error.value.lines == [expected]


def test_a_byte_order_mark_is_no_fault(tmp_path, example):
    (tmp_path / "x.yaml").write_text(example, encoding="utf-8-sig")
    assert load(tmp_path / "x.yaml").title == "example"


def test_an_effect_that_nothing_resembles_says_how_ones_own_are_named(example):
    with pytest.raises(SceneError) as told:
        loads(example, overrides=["effects.qqqqqq={}"])
    assert "effects.qqqqqq: is not known; known here: " in str(told.value)
    assert str(told.value).endswith("(one of your own has a dotted name, e.g. my_effects.spring)")
    with pytest.raises(SceneError) as told:
        loads(example, overrides=["effects.blow_hol={}"])
    assert str(told.value).endswith("did you mean 'blow_hole'?")


def test_an_own_effect_that_is_not_there_says_what_was_tried(example):
    assert faults_of(example.replace("  mechanical: {fraction: 0.05}", "  no_such_package.effect:")) == [
        "x.yaml:42:3: effects.no_such_package.effect: cannot be imported (No module named 'no_such_package'); "
        "tried PYTHONPATH and the working folder (is it there?)"
    ]


@each_row("override", ["operation.speed", "=3", "a..b=3", ".a=3", "base=y.yaml"])
def test_a_malformed_override_is_a_wrong_use(example, override):
    with pytest.raises(UsageError):
        loads(example, overrides=[override])


def test_without_an_inactive_effect_lists_the_active_ones(example):
    text = example[: example.index("  tip_leakage")]
    with pytest.raises(UsageError) as error:
        loads(text, without=["blow_hole"])
    assert str(error.value) == (
        "--without blow_hole: that effect is not active in this scene (active: suction_port, discharge_port)"
    )


def test_a_long_mapping_on_the_command_line_is_not_repeated_with_each_of_its_faults():
    bearings = "{load: gas, radial_area: 30 cm^2, axial_area: 20 cm^2, shaft_diameter: 60 mm, female_load: 1}"
    with pytest.raises(SceneError) as refused:
        load(Path(__file__).parents[2] / "configs/paper/point.yaml", [f"effects.bearings={bearings}"])
    assert len(refused.value.lines) > 1
    assert all(line.startswith("--set effects.bearings=…: effects.bearings.") for line in refused.value.lines)
