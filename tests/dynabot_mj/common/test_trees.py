from dynabot_mj.common.trees import flat


def test_values_have_the_names_of_their_tables():
    tree = {"seed": 3, "radio": {"message_bytes": 20, "deep": {"a": [1, 2]}}, "empty": {}}
    assert dict(flat(tree)) == {"seed": 3, "radio.message_bytes": 20, "radio.deep.a": [1, 2]}
