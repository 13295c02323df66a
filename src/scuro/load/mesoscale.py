"""What comes in JSON: cell-scale models (cellPACK's results and serialized pair), probes' paths.

The other forms of models have readers of their own: the BinaryCIF of Mol* Mesoscale Explorer
(:mod:`scuro.load.mesoscale_bcif`) and scuro's own tables (:mod:`scuro.load.mesoscale_table`).
"""

from __future__ import annotations

import json
from typing import Any

from scuro.errors import LoadError
from scuro.load.mesoscale_cellpack import model_of_recipe
from scuro.load.mesoscale_serialized import model_of_serialized
from scuro.load.mesoscale_structures import StructureLibrary
from scuro.load.options import LoadOptions
from scuro.load.source import Source
from scuro.load.track import track_of
from scuro.scene.model import MesoscaleModel
from scuro.scene.track import Track


def read_json(source: Source, options: LoadOptions) -> MesoscaleModel | Track:
    """Read a cellPACK model of either JSON form, or the path of a probe.

    ``options.structures`` names a folder of ingredient structures that is searched before the
    model's own; with ``options.strict`` a missing structure is an error, else spheres stand for it.

    Raises:
        LoadError: The file is damaged, or of a form or version that is not known.
    """
    content = parse_object(source)
    if "points" in content:
        return track_of(source, content)
    library = StructureLibrary(source, options)
    if "recipe" in content:
        return model_of_recipe(source, content, library)
    if "IngredientGroups" in content or "Compartments" in content:
        return model_of_serialized(source, content, library)
    raise LoadError(
        source.name,
        "is not a cellPACK model: it has neither a 'recipe' nor 'Compartments' at its top level; "
        "nor is it the path of a probe, which has 'points'",
    )


def parse_object(source: Source) -> dict[str, Any]:
    """The object in a JSON file."""
    try:
        content = json.loads(source.data)
    except json.JSONDecodeError as error:
        raise LoadError(source.name, f"is not valid JSON: {error.msg}", error.lineno) from None
    except UnicodeDecodeError:
        raise LoadError(source.name, "is not JSON: it holds bytes that are not text") from None
    except RecursionError:
        raise LoadError(source.name, "is nested too deeply to be a model") from None
    if not isinstance(content, dict):
        raise LoadError(source.name, "is not a cellPACK model: its top level is not an object")
    return content
