# The package as pages, made of its docstrings; with the package in PYTHONPATH:
#   python3 -m sphinx -W -b html pipeline/python/docs build/docs
import palpate

project = "palpate for Python"
version = release = palpate.__version__
extensions = ["sphinx.ext.autodoc"]
default_role = "code"
html_theme = "alabaster"
html_theme_options = {"page_width": "75em", "body_max_width": "none"}  # room for tables of parameters
html_show_copyright = False
highlight_language = "none"
add_module_names = False
autoclass_content = "both"
autodoc_member_order = "groupwise"
autodoc_typehints = "none"  # the stubs tell them


def clean(text):
    return text and text.replace("palpate._core.", "").replace("Overloaded function.", "")


def signature_of(app, what, name, obj, options, signature, returned):
    """Without the extension's name. How a class is made stands in its text; results are made by the package alone."""
    if what in ("class", "exception"):
        return "", None
    return clean(signature and signature.replace(f"self: palpate._core.{name.split('.')[1]}", "self")), clean(returned)


def text_of(app, what, name, obj, options, lines):
    lines[:] = map(clean, lines)


def setup(app):
    app.connect("autodoc-process-signature", signature_of)
    app.connect("autodoc-process-docstring", text_of)
