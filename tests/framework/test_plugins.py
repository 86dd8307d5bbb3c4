"""The loader, with entry points made by hand: each plugin is judged on its own."""

import itertools
import json
import sys
import tomllib
from collections.abc import Callable
from functools import partial
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from pellicle import ConfigError, Kernel, PluginError, Run
from pellicle.components.installed import FAMILIES, registry
from pellicle.config.explain import explanations, words_by_kind
from pellicle.config.json_schema import model_schema
from pellicle.plugins.origins import GROUP, Origin
from pellicle.plugins.registry import Registry
from pellicle.plugins.registry import load as load_plugins
from pellicle_fit.effect import Effect
from pellicle_fit.files.reader import Reader
from tests.command import call
from tests.installed import Installed, entry_point

BUILT_INS = tuple(entry_points(group=GROUP, name="kernel.half_space"))
SOFT = '''
from collections.abc import Callable
from typing import Annotated, Literal
from pydantic import Field
from pellicle import Isotropic, Kernel, Output, hookimpl
from pellicle.components import Component
from pellicle.units import Quantity

class Soft(Isotropic):
    """Kernel of a stranger."""

    type: Literal["soft"] = "soft"
    scale: Annotated[float, Field(description="scale of G [m/Pa]")] = 1.0

    def compliance(self, q):
        return self.scale / q

@hookimpl
def register_components(register):
    register(Soft)
'''
TYPE = 'type: Literal["soft"] = "soft"'
DOCSTRING = '"""Kernel of a stranger."""'
FIELD = 'Annotated[float, Field(description="scale of G [m/Pa]")] = 1.0'
REGISTER = "    register(Soft)\n"
SUITE = "@hookimpl\ndef register_validations(register):\n    register"
BROKEN = {
    "raises at import": ("", "raise OSError('no library')", "OSError: no library"),
    "exits at import": ("", "raise SystemExit(3)", "SystemExit: 3"),
    "hook of one family": ("register_comp", "register_k", "; did you mean 'register_components'?"),
    "no hook": ("@hookimpl", "", "implements no hook; decorate with @pellicle.hookimpl"),
    "wrong argument": ("(register):", "(add):", "'add'"),
    "fails half-way": (REGISTER, REGISTER + "    1 / 0\n", "ZeroDivisionError"),
    "no suite": (REGISTER, f"{REGISTER}{SUITE}(())\n", "() is not a function that yields cases"),
    "fails at last": (REGISTER, f"{REGISTER}{SUITE}(list)\n    1 / 0\n", "ZeroDivisionError"),
    "no class": ("register(Soft)", "register(Soft())", "not a subclass of pellicle.components.C"),
    "no type": (TYPE, "", "Soft needs a field: type: Literal"),
    "any text as type": (TYPE, 'type: str = "soft"', "Soft needs a field: type: Literal"),
    "two types": (TYPE, 'type: Literal["a", "b"] = "a"', "Soft needs a field: type: Literal"),
    "number as type": (TYPE, "type: Literal[1] = 1", "Soft needs a field: type: Literal"),
    "type without default": (TYPE, 'type: Literal["soft"]', 'Soft.type needs the default "soft"'),
    "other default": (TYPE, 'type: Literal["soft"] = "s"', 'Soft.type needs the default "soft"'),
    "no method": ("compliance", "stiffness", "Soft lacks the method compliance"),
    "shows nothing": (
        "Soft(Isotropic)",
        "Soft(Output)",
        "Soft lacks the method charts, or write",
    ),
    "no docstring": (DOCSTRING, "", "Soft lacks a docstring"),
    "bare field": (FIELD, "float = 1.0", "Soft.scale lacks Field(description=…)"),
    "unknown unit": ("float,", "float, Quantity('ell'),", "Soft.scale: Quantity('ell') has an unk"),
    "other family": (TYPE, TYPE + '\n    family = "x"', "Soft.family is 'x'; leave it to Kernel"),
    "no family": (
        "Soft(Isotropic)",
        "Soft(Component)",
        "Soft is of no family; derive it from a base",
    ),
    "its own base": (
        f"Soft(Isotropic):\n    {DOCSTRING}",
        f"Soft(Component):\n    {DOCSTRING}\n    family = 'x'; place = 'x'",
        "Soft is the base class of a family; derive from it",
    ),
    "no place": (
        "class Soft(Isotropic):",
        "class X(Component): family = 'x'\nclass Soft(X):",
        "X lacks the class variable place",
    ),
    "field of no known type": ("Annotated[float,", "Annotated['Unknown',", "Unknown"),
    "field without JSON": ("Annotated[float,", "Annotated[Callable[[], int],", "JsonSchema"),
}
"""What is replaced in `SOFT`, by what (nothing is replaced: put in front), and what is said."""

Plugin = Callable[..., EntryPoint]
load = partial(load_plugins, known=FAMILIES)
_numbers = itertools.count()


@pytest.fixture
def plugin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Plugin:
    """Return a function that writes a plugin module and returns its entry point."""
    monkeypatch.syspath_prepend(tmp_path)

    def write(
        source: str,
        name: str = "kernel.soft",
        distribution: str = "stranger",
        version: str = "1.2",
        class_: str = "",
    ) -> EntryPoint:
        module = f"stranger_{next(_numbers)}"
        (tmp_path / f"{module}.py").write_text(source, encoding="utf-8")
        return entry_point(name, f"{module}:{class_}".removesuffix(":"), distribution, version)

    return write


def test_a_good_plugin_is_registered_with_its_origin(plugin: Plugin) -> None:
    """A component is found by family and type, and knows the distribution it comes from."""
    plugins = load([plugin(SOFT)])
    registered = plugins.components["kernel"]["soft"]
    assert registered.origin == Origin("kernel.soft", "stranger", "1.2")
    assert registered.summary == "Kernel of a stranger."
    assert plugins.find("kernel", "soft") is registered.component
    assert plugins.broken == ()
    assert plugins.make(Kernel, {"type": "soft", "scale": 2}).model_dump() == {
        "type": "soft",
        "scale": 2.0,
    }


def test_an_entry_point_may_name_the_class(plugin: Plugin) -> None:
    """Then the module needs no hook, and what else is in it does not count."""
    entry = plugin(SOFT.partition("@hookimpl")[0] + "class Soft2(Soft): ...\n", class_="Soft")
    assert load([entry]).find("kernel", "soft").__name__ == "Soft"


@pytest.mark.parametrize(
    ("class_", "error"),
    [
        ("Sofft", "has no attribute 'Sofft'"),
        ("Quantity", "is not a subclass of pellicle.components.Component"),
        ("Kernel", "Kernel is the base class of a family; derive from it"),
        ("TYPE", "implements no hook"),
    ],
)
def test_an_entry_point_that_names_no_component_is_broken(
    plugin: Plugin, class_: str, error: str
) -> None:
    """What it names instead is said, and the other plugins work."""
    plugins = load([plugin(f"TYPE = 3\n{SOFT}", class_=class_), *BUILT_INS])
    assert [error in broken.error for broken in plugins.broken] == [True]
    assert list(plugins.components["kernel"]) == ["half_space"]


ARTEFACT = '''
from typing import Annotated, Literal
from pydantic import Field
from pellicle.components import Component, FromRegistry
from pellicle.schema import Model
from pellicle.units import Quantity
from tests.command import call

class Artefact(Component):
    """What bends a curve."""

    family = "artefact"
    place = "rivals[]"

class Drift(Artefact):
    """Drift of the base."""

    type: Literal["drift"] = "drift"
    examples = ({"rate": "1 nm/s"},)
    rate: Annotated[float, Quantity("m/s"), Field(description="rate [m/s]")]

class Fit(Model):
    """A file of a stranger."""

    rivals: tuple[Annotated[Artefact, FromRegistry()], ...]
'''


@pytest.fixture
def install(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Registry]:
    """Return a function that makes plugins, beside our own, those that are installed."""

    def install(*entries: EntryPoint) -> Registry:
        installed = load([*entries, *entry_points(group=GROUP)])
        for module in ("components.installed", "config.explain", "config.json_schema"):
            monkeypatch.setattr(f"pellicle.{module}.registry", lambda: installed)
        return installed

    return install


def test_a_plugin_may_bring_a_family(plugin: Plugin, install: Callable[..., Registry]) -> None:
    """By a base class alone: fields hold its components, schemas and explanations have them."""
    entry = plugin(ARTEFACT, name="artefact.drift", class_="Drift")
    installed = install(entry)
    stranger = import_module(entry.module)
    families = {**FAMILIES, "artefact": stranger.Artefact, "effect": Effect, "reader": Reader}
    assert installed.families == families
    (drift,) = stranger.Fit(rivals=[{"type": "drift", "rate": "1 nm/s"}]).rivals
    assert (type(drift), drift.rate) == (stranger.Drift, 1e-9)
    with pytest.raises(ConfigError) as raised:
        stranger.Fit(rivals=[{"type": "drif"}])
    assert str(raised.value) == (
        "rivals.0.type: 'drif' is not an artefact; did you mean 'drift'? Known: drift"
    )
    schema = model_schema(stranger.Fit)
    Draft202012Validator(schema).validate({"rivals": [{"type": "drift", "rate": "1 nm/s"}]})
    assert not Draft202012Validator(schema).is_valid({"rivals": [{"type": "drift"}]})
    assert schema["$defs"].keys() == {"Drift"}
    assert "Drift" not in model_schema(Run)["$defs"]
    assert words_by_kind({})["artefact"] == ["drift"]
    (family,) = explanations("artefacts", {})
    assert (family.text, [row.name for row in family.fields]) == ("What bends a curve.", ["drift"])
    (explanation,) = explanations("artefact.drift", {})
    assert explanation.example.startswith("[[rivals]]\n")
    assert stranger.Fit(**tomllib.loads(explanation.example)).rivals[0].rate == 1e-9


def test_a_family_checks_its_own_classes(plugin: Plugin) -> None:
    """The rule of a stranger's family holds for its components, as those of ours do."""
    rule = """
    @classmethod
    def check_class(cls):
        if len(cls.model_fields) > 1:
            raise PluginError(f"{cls.__name__} has a field")
"""
    place = 'place = "rivals[]"\n'
    source = "from pellicle import PluginError" + ARTEFACT.replace(place, place + rule)
    (broken,) = load([plugin(source, name="artefact.drift", class_="Drift")]).broken
    assert broken.error == "Drift has a field"


def test_a_family_has_one_base(plugin: Plugin, install: Callable[..., Registry]) -> None:
    """Of two bases of one name the later plugin is broken; ours cannot be taken."""
    first, later = (plugin(ARTEFACT, name=f"artefact.{n}", class_="Drift") for n in "ab")
    thief = plugin(ARTEFACT.replace('"artefact"', '"kernel"'), name="a", class_="Drift")
    installed = install(first, later, thief)
    errors = {broken.origin.entry_point: broken.error for broken in installed.broken}
    assert errors.keys() == {"a", "artefact.b"}
    assert f"{later.module}.Artefact and {first.module}.Artefact both" in errors["artefact.b"]
    assert f"{thief.module}.Artefact and pellicle.components.kernel.Kernel both" in errors["a"]
    assert installed.find("artefact", "drift").__module__ == first.module
    with pytest.raises(ConfigError, match=f"is a {first.module}.Drift, not a {later.module}.Ar"):
        import_module(later.module).Fit(rivals=[{"type": "drift", "rate": 1}])


def test_a_family_whose_application_is_not_installed(
    plugin: Plugin, install: Callable[..., Registry]
) -> None:
    """A field and a search say so; that the plugin is broken or switched off comes first."""
    entry = plugin(ARTEFACT, name="artefact.drift", class_="Drift")
    stranger = entry.load().__module__
    install()
    for table in ({"type": "drift"}, {}):
        with pytest.raises(
            PluginError, match="no installed plugin brings the family 'artefact'; Kn"
        ):
            import_module(stranger).Fit(rivals=[table])
    with pytest.raises(
        ConfigError, match="'artefact' is neither a type, a family nor a table of what is"
    ):
        explanations("artefact", {})
    with pytest.raises(PluginError, match="artefact 'drift' is broken"):
        load([plugin("raise OSError", name="artefact.drift")]).find("artefact", "drift")
    with pytest.raises(PluginError, match="switched off"):
        load([entry], disable="stranger").find("artefact", "drift")


def test_commands_are_not_loaded_with_components(plugin: Plugin) -> None:
    """A module of a command is imported when the command is called."""
    assert load([plugin("raise OSError", name="command.fit")]) == load([])


def test_one_plugin_may_bring_several_families(plugin: Plugin) -> None:
    """All hooks of a module are called; a package may name it once for each component in it."""
    more = SOFT.replace(REGISTER, f"{REGISTER}    register(Exact)\n") + (
        "from pellicle import AreaCorrection\n"
        "class Exact(AreaCorrection):\n"
        '    """Area of a stranger."""\n'
        '    type: Literal["exact"] = "exact"\n'
        "    def area(self, contact, spacing): return 1.0\n"
        f"{SUITE}(list)\n"
    )
    first = plugin(more, name="everything")
    second = entry_point("correction.exact", first.value, "stranger", "1.2")
    plugins = load([first, second])
    assert plugins.find("correction", "exact").__name__ == "Exact"
    assert plugins.find("kernel", "soft").__name__ == "Soft"
    assert (plugins.suites, plugins.clashes) == ((list,), {})


@pytest.mark.parametrize(("old", "new", "error"), BROKEN.values(), ids=BROKEN.keys())
def test_a_broken_plugin_is_named_and_nothing_of_it_registered(
    plugin: Plugin, old: str, new: str, error: str
) -> None:
    """What is wrong is written down with its origin, and the other plugins work."""
    assert old in SOFT
    plugins = load([plugin(SOFT.replace(old, new, 1) if old else new + SOFT), *BUILT_INS])
    assert [broken.origin for broken in plugins.broken] == [
        Origin("kernel.soft", "stranger", "1.2")
    ]
    assert error in plugins.broken[0].error
    registered = [type_ for members in plugins.components.values() for type_ in members]
    assert (registered, plugins.suites) == (["half_space"], ())


def test_what_a_plugin_prints_at_import_is_no_output(
    plugin: Plugin, capsys: pytest.CaptureFixture[str]
) -> None:
    """It comes on standard error, and the plugin is as good as before."""
    source = SOFT.replace(REGISTER, REGISTER + "    print('from a hook')\n")
    plugins = load([plugin(f"print('from a module')\n{source}")])
    assert plugins.find("kernel", "soft").__name__ == "Soft"
    assert capsys.readouterr() == ("", "from a module\nfrom a hook\n")


SOFT_RUN = """
grid = { points = 16, size = "0.4 mm" }
kernel = { type = "soft", scale = 1e-4 }
indenter = { type = "paraboloid", radius = "1 mm" }
loading = { depth = "20 um" }
outputs = []
"""


def test_a_component_that_cannot_be_made_is_named(plugin: Plugin) -> None:
    """What a validator of a plugin raises comes with the component's name."""
    failing = SOFT.replace("    def comp", "    def model_post_init(self, _): {}[0]\n    def comp")
    with pytest.raises(KeyError) as raised:
        load([plugin(failing)]).make(Kernel, {"type": "soft"})
    assert "kernel 'soft' failed" in raised.value.__notes__[0]


def test_what_a_component_prints_is_not_in_the_json(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`run --json` prints nothing else, whatever components print, also without contact."""
    paraboloid: Any = registry().find("indenter", "paraboloid")
    profile = paraboloid.profile

    def printing(*given: Any) -> Any:
        sys.stdout.write("hello")
        return profile(*given)

    monkeypatch.setattr(paraboloid, "profile", printing)
    file = tmp_path / "a.toml"
    file.write_text(SOFT_RUN.replace('"soft", scale', '"half_space", reduced_modulus'))
    words = ["run", str(file), "-o", str(tmp_path), "--json", "--set", "loading.depth=0"]
    shown = json.loads(call(*words).stdout)
    assert shown["converged"] is True
    assert shown["files"] == [str(tmp_path / "a.h5")]
    assert shown["steps"][0]["mean_contact_pressure"] is None


def test_a_broken_plugin_is_an_error_when_asked_for(plugin: Plugin) -> None:
    """The message holds type, entry point, distribution, version and what went wrong."""
    plugins = load([plugin("raise OSError('no library')")])
    with pytest.raises(PluginError) as raised:
        plugins.make(Kernel, {"type": "soft"})
    assert str(raised.value) == (
        "kernel 'soft' is broken: stranger 1.2 (entry point 'kernel.soft'): OSError: no library"
    )


def test_two_owners_of_one_name_are_both_named(plugin: Plugin) -> None:
    """No claimant is used, not even our own; asking for the name raises, other names work."""
    rivals = [plugin(SOFT), plugin(SOFT, distribution="rival", version="7")]
    thief = plugin(SOFT.replace('"soft"', '"half_space"'), name="better")
    plugins = load([*rivals, thief, *BUILT_INS, *entry_points(group=GROUP, name="kernel.winkler")])
    for type_, owners in (
        ("soft", ["stranger 1.2", "rival 7"]),
        ("half_space", ["stranger 1.2 (entry point 'better')", "pellicle "]),
    ):
        with pytest.raises(PluginError, match="is claimed by") as raised:
            plugins.find("kernel", type_)
        for part in (*owners, "uninstall", "PELLICLE_DISABLE_PLUGINS"):
            assert part in str(raised.value)
    assert list(plugins.components["kernel"]) == ["winkler"]


def test_another_version_of_a_plugin_makes_another_run(
    plugin: Plugin, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Results of an earlier version of a plugin are not taken for those of the present one."""
    entry = plugin(SOFT)
    identities = []
    for dist in (entry.dist, Installed("stranger", "1.2"), Installed("stranger", "1.3")):
        vars(entry).update(dist=dist)
        plugins = load([entry, *entry_points(group=GROUP)])
        monkeypatch.setattr("pellicle.config.provenance.registry", lambda loaded=plugins: loaded)
        configuration = tomllib.loads(SOFT_RUN)
        configuration["kernel"] = plugins.make(Kernel, configuration["kernel"])
        identities.append(Run(**configuration).identity)
    first, same, other = identities
    assert first == same != other


@pytest.mark.parametrize(
    "disable", ["1", "all", "my-stranger", "My_Stranger", "kernel.soft", "other, kernel.soft"]
)
def test_strangers_are_switched_off(plugin: Plugin, disable: str) -> None:
    """All strangers, a distribution in any spelling, or one entry point can be switched off."""
    plugins = load([plugin(SOFT, distribution="my-stranger"), *BUILT_INS], disable)
    assert list(plugins.components["kernel"]) == ["half_space"]
    assert plugins.disabled == (Origin("kernel.soft", "my-stranger", "1.2"),)
    with pytest.raises(PluginError, match="switched off by PELLICLE_DISABLE_PLUGINS"):
        plugins.find("kernel", "soft")


@pytest.mark.parametrize("disable", ["", "0", "strange", "soft", "pellicle", "kernel.half_space"])
def test_what_is_not_named_or_our_own_stays_on(plugin: Plugin, disable: str) -> None:
    """Only whole names switch a plugin off, and none pellicle's own components."""
    kernels = load([plugin(SOFT), *BUILT_INS], disable).components["kernel"]
    assert kernels.keys() == {"soft", "half_space"}
