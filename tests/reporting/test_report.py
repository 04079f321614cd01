from armour.reporting.report import reference_notes


def test_references_are_those_cited_in_the_order_of_the_texts():
    found = dict(reference_notes(("[Wilkins] and [Paper]", "[Ryan2023], as [Paper] [none]")))
    assert [*found] == ["Wilkins", "Paper", "Ryan2023"]
    assert found["Ryan2023"].startswith("S. Ryan, ")
    assert found["Ryan2023"].endswith("2023, doi 10.17632/4f92y6jzzh.2")
