"""An effect that a function of Python's tells."""

import unittest

import numpy as np
import palpate
from bodies import measured, model

TIP = (60.0, 10.0, 20.0)


@palpate.effect("weight", {"gz": ("mm/s^2", 9810.0)}, acts_on="material", meaning="Its own weight.")
def weight(X, x, gz):
    return -gz * x[2], (0, 0, -gz), np.zeros((3, 3))


@palpate.effect("broken", {"k": ("N/mm^3", 1.0)})
def broken(X, x, k):
    raise ZeroDivisionError("of one's own")


@palpate.effect("short", {"k": ("N/mm^3", 1.0)})
def short(X, x, k):
    return 0.0, x


class OwnEffect(unittest.TestCase):
    def test_plays_as_the_one_of_the_catalogue(self):
        ours = palpate.simulate(model().with_effect("weight", gz=-9810.0), measured())
        theirs = palpate.simulate(model().with_effect("gravity", gx=0.0, gy=0.0, gz=-9810.0), measured())
        np.testing.assert_allclose(ours.displacement, theirs.displacement, atol=1e-9 * theirs.largest.max())

    def test_is_in_the_catalogue_and_fitted(self):
        self.assertEqual(palpate.effects("weight")["meaning"], "Its own weight.")
        ladder = palpate.improve(model(), measured(), "weight", body="skeleton", parameters="uniform", particles=20)
        self.assertEqual([e["name"] for e in ladder.model.effects], ["weight"])

    def test_what_it_raises_ends_the_work(self):
        for name, kind, words in (
            ("broken", ZeroDivisionError, "of one's own"),
            ("short", palpate.InvalidInput, "must return"),
        ):
            with self.assertRaisesRegex(kind, words):
                palpate.simulate(model().with_effect(name, k=1.0), measured(), threads=2)
        palpate.simulate(model(), measured())

    def test_what_cannot_be_is_refused(self):
        for name, numbers, acts_on, words in (
            ("gravity", {"k": ("1", 1.0)}, "surface", "known already"),
            ("a", {"k": ("1", 0.0)}, "surface", "prior_sd"),
            ("b", {"k": ("1", 1.0)}, "air", "acts_on"),
        ):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                palpate.effect(name, numbers, acts_on=acts_on)(lambda X, x, k: None)
        with self.assertRaisesRegex(TypeError, "prior_sd"):
            palpate.effect("c", {"k": 1.0})
        with self.assertRaisesRegex(palpate.InvalidInput, "gz"):
            model().with_effect("gravity", gx=0.0, gy=0.0)


if __name__ == "__main__":
    unittest.main()
