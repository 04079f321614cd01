from armour.reporting.table import Table
from armour.reporting.tables.library import entry_table, entry_tables, library_table, library_tables
from armour.scenario.library import KINDS, shipped_library


def test_entries_of_a_kind():
    table = library_table(shipped_library(), "ceramic")
    assert table.headings() == ["ceramic", "density, kg/m³", "Young's modulus, GPa", "flow stress, GPa", "description"]
    assert ["AD85", "3430", "267", "5.2", "alumina, 85 %"] in table.texts()
    assert library_table(shipped_library(), "projectile").headings()[1] == "calibre, mm"


def test_a_value_that_an_entry_does_not_have_is_empty():
    table = library_table(shipped_library(), "projectile")
    [apds] = [dict(zip(table.headings(), row, strict=True)) for row in table.texts() if row[0] == "25 mm APDS"]
    assert apds["projectile mass, g"] == ""


def test_a_table_for_every_kind():
    tables = library_tables(shipped_library())
    assert [table.columns[0].label for table in tables if isinstance(table, Table)] == list(KINDS)


def test_an_entry_has_its_sources():
    [entry] = shipped_library().find("AD85")
    expected = ("flow_stress_GPa", 5.2, "fitted", "the paper, table 2, to Wilkins' ballistic limits")
    assert expected in entry_table(entry).rows
    assert entry_tables(entry)[0] == "alumina, 85 %"
