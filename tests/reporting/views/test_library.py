from armour.cli.layout import rendered
from armour.reporting.table import Table
from armour.reporting.views.library import entry_table, entry_tables, library_table, library_tables
from armour.scenario.library import KINDS, shipped_library


def test_entries_of_a_kind():
    table = library_table(shipped_library(), "ceramic")
    assert table.headings() == ["ceramic", "density, kg/m³", "Young's modulus, GPa", "flow stress, GPa", "description"]
    assert ["AD85", "3430", "267", "5.2", "alumina, 85 %"] in table.texts()
    assert library_table(shipped_library(), "projectile").headings()[1] == "penetrator diameter, mm"


def test_the_tables_fit_a_terminal_of_80_columns():
    for table in library_tables(shipped_library()):
        lines = rendered([table], 80).splitlines()
        assert [line for line in lines[:6] if set(line) == {"─"}], "blocks, not a table"


def test_a_table_for_every_kind():
    tables = library_tables(shipped_library())
    assert [table.columns[0].label for table in tables if isinstance(table, Table)] == list(KINDS)


def test_an_entry_has_its_sources():
    [entry] = shipped_library().find("AD85")
    expected = ("flow_stress_GPa", 5.2, "fitted", "[Paper], table 2, to Wilkins' ballistic limits")
    assert expected in entry_table(entry).rows
    assert entry_tables(entry)[0] == "alumina, 85 %"
