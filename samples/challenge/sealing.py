"""Truths under seal: what is published of each is SHA-256(salt + truth), which the salt and the truth open later."""

import hashlib
import json
import secrets


def digest(salt, truth):
    text = json.dumps(truth, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256((salt + text).encode()).hexdigest()


def seal(truths):
    """Two tables by set: commitments, to be published with the sets, and keys, to be kept until the challenge ends."""
    keys = {name: {"salt": secrets.token_hex(16), "truth": truth} for name, truth in truths.items()}
    return {name: digest(key["salt"], key["truth"]) for name, key in keys.items()}, keys


def open_seals(commitments, keys):
    """The truths; ValueError names a set whose truth is not the one that was committed to."""
    for name, commitment in commitments.items():
        if name not in keys:
            raise ValueError(f"set {name}: there is no key for its seal; the keys' file has to hold every set")
        if digest(keys[name]["salt"], keys[name]["truth"]) != commitment:
            raise ValueError(f"set {name}: its truth is not the one that was sealed; use the keys that were made with it")
    return {name: keys[name]["truth"] for name in commitments}
