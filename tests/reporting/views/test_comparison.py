from armour.reporting.views.comparison import comparison_table, fit_table
from armour.validation.comparison import compare
from tests.helpers.cases import scenario


def test_florence_beside_the_model():
    result = compare(scenario())
    table = comparison_table(result)
    assert table.rows[0] == ("this model", result.limit.ballistic_limit_m_s, *(None,) * 6)
    assert [row[0] for row in table.rows[1:]] == [
        "Florence, penetrator (5.46 g, 6.5 mm)",
        "Florence, whole projectile (8.32 g, 7.62 mm)",
        "areal density rule, p = 1",
        "areal density rule, p = 0.9376",
    ]
    assert table.texts()[1][2] == f"{100 * (result.florence[0].ballistic_limit_m_s / 723.7716 - 1):+.1f}"
    assert [row[0] for row in fit_table(result).rows] == ["Lambert-Jonas", "Recht-Ipson"]
