#include <puppetwarp/project/puppet_schema.h>

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/project/puppet_json.h>
#include <puppetwarp/weights/weights.h>

namespace puppetwarp {

namespace {

// Names of methods and weights, an empty `enum` here, are filled in from where they are defined.
constexpr const char* schema_text = R"schema({
  "$schema": "https://json-schema.org/draft/2020-12/schema",
  "title": "a puppet file of puppetwarp, version 1",
  "description": "All that a person chose for a puppet. Paths are relative to the file. Further keys are kept.",
  "type": "object",
  "required": ["format", "version"],
  "properties": {
    "format": { "description": "Says that this is a puppet file.", "const": "puppetwarp" },
    "version": { "description": "Of the file format.", "const": 1 },
    "image": { "description": "Path of the picture. Needed where a picture is needed.", "type": "string" },
    "cutout": { "$ref": "#/$defs/cutout" },
    "background": {
      "description": "Behind the subject: nothing, the picture, it filled where the subject was, #rrggbb or #rrggbbaa.",
      "type": "string",
      "anyOf": [
        { "enum": ["transparent", "keep", "inpaint"] },
        { "maxLength": 9, "pattern": "^#[0-9a-fA-F]{6}([0-9a-fA-F]{2})?$" }
      ],
      "default": "transparent"
    },
    "back_faces": {
      "description": "Triangles that are folded over are not drawn, or drawn mirrored.",
      "enum": ["hide", "show"],
      "default": "hide"
    },
    "mesh": { "$ref": "#/$defs/mesh" },
    "handles": {
      "description": "What takes hold of the subject, at rest. Ids are unique.",
      "type": "array",
      "items": { "$ref": "#/$defs/handle" }
    },
    "stiffness": {
      "description": "Where the subject resists more, or less. Factors multiply where several apply.",
      "type": "array",
      "items": { "$ref": "#/$defs/stiffness" }
    },
    "method": { "$ref": "#/$defs/method" },
    "poses": {
      "description": "Targets of the handles. Names are unique; the first pose is the usual one.",
      "type": "array",
      "items": { "$ref": "#/$defs/pose" }
    }
  },
  "examples": [
    {
      "format": "puppetwarp", "version": 1,
      "image": "gingerbread.png",
      "handles": [ { "id": "hand", "type": "point", "at": [120.5, 88] } ],
      "method": { "name": "arap" },
      "poses": [ { "name": "wave", "handles": { "hand": { "to": [150, 30], "rotate_deg": 20 } } } ]
    }
  ],
  "$defs": {
    "point": {
      "title": "a point [x, y]",
      "description": "Pixels from the picture's upper left corner, x right, y down; outside it too.",
      "type": "array",
      "items": { "type": "number" },
      "minItems": 2,
      "maxItems": 2
    },
    "polygon": {
      "title": "at least three points",
      "description": "Corners in their order; the last is joined to the first.",
      "type": "array",
      "items": { "$ref": "#/$defs/point" },
      "minItems": 3
    },
    "stiffness_factor": {
      "description": "Multiplies first-order energies; 1 changes nothing.",
      "type": "number",
      "minimum": 0.000001,
      "maximum": 1000000
    },
    "cutout": {
      "description": "Which pixels are the subject.",
      "type": "object",
      "properties": {
        "from": {
          "description": "auto: alpha where some pixel's alpha is below half, else whole. mask: a grey picture.",
          "enum": ["auto", "alpha", "mask", "polygon", "whole"],
          "default": "auto"
        },
        "path": {
          "description": "Of the mask: a picture of the same size, white where the subject is.",
          "type": "string"
        },
        "points": { "description": "Of the polygon.", "$ref": "#/$defs/polygon" },
        "holes": {
          "description": "Of the polygon: what is not the subject inside it.",
          "type": "array",
          "items": { "$ref": "#/$defs/polygon" }
        }
      },
      "allOf": [
        {
          "if": { "properties": { "from": { "const": "mask" } }, "required": ["from"] },
          "then": { "properties": { "path": { "minLength": 1 } }, "required": ["path"] }
        },
        {
          "if": { "properties": { "from": { "const": "polygon" } }, "required": ["from"] },
          "then": { "required": ["points"] }
        }
      ]
    },
    "mesh": {
      "description": "The triangles over the subject. What is absent is chosen from the subject's size.",
      "type": "object",
      "properties": {
        "max_edge_px": { "description": "Longest edge, pixels.", "type": "number", "exclusiveMinimum": 0 },
        "min_angle_deg": {
          "description": "Smallest angle, degrees.",
          "type": "number",
          "minimum": 0,
          "maximum": 30,
          "default": 25
        },
        "expand_px": {
          "description": "How far the outline is grown, pixels.",
          "type": "number",
          "minimum": 0,
          "default": 2
        }
      }
    },
    "handle": {
      "description": "A handle and where it rests.",
      "type": "object",
      "properties": {
        "id": { "description": "Names the handle in poses.", "type": "string", "minLength": 1 },
        "type": {
          "description": "A disc; a segment; a polygon of which corners are moved, or all; a mesh file's vertex.",
          "enum": ["point", "bone", "cage", "region", "vertex"]
        }
      },
      "required": ["id", "type"],
      "allOf": [
        {
          "if": { "properties": { "type": { "const": "point" } } },
          "then": {
            "properties": {
              "at": { "description": "Centre of the disc.", "$ref": "#/$defs/point" },
              "radius_px": {
                "description": "Of the disc that is held, pixels. Absent: a fixed share of the subject's size.",
                "type": "number",
                "exclusiveMinimum": 0
              }
            },
            "required": ["at"]
          }
        },
        {
          "if": { "properties": { "type": { "const": "bone" } } },
          "then": {
            "properties": {
              "from": { "description": "Its start, about which it turns.", "$ref": "#/$defs/point" },
              "to": { "description": "Its end, elsewhere than its start.", "$ref": "#/$defs/point" },
              "parent": {
                "description": "Id of the bone that it follows. Absent or empty: none.",
                "type": "string"
              },
              "length": {
                "description": "Where its ends are sent to another distance: it stretches, or only turns.",
                "enum": ["stretch", "fixed"],
                "default": "stretch"
              }
            },
            "required": ["from", "to"]
          }
        },
        {
          "if": { "properties": { "type": { "const": "cage" } } },
          "then": {
            "properties": { "points": { "description": "Its corners.", "$ref": "#/$defs/polygon" } },
            "required": ["points"]
          }
        },
        {
          "if": { "properties": { "type": { "const": "region" } } },
          "then": {
            "properties": {
              "points": { "description": "What it holds.", "$ref": "#/$defs/polygon" },
              "falloff": {
                "description": "How its motion fades: as the method says, harmonically, by distance inside.",
                "enum": ["none", "harmonic", "geodesic"],
                "default": "none"
              }
            },
            "required": ["points"]
          }
        },
        {
          "if": { "properties": { "type": { "const": "vertex" } } },
          "then": {
            "properties": {
              "index": {
                "description": "Of the vertex in the mesh file, counted from 0.",
                "type": "integer",
                "minimum": 0,
                "maximum": 2147483647
              }
            },
            "required": ["index"]
          }
        }
      ]
    },
    "stiffness": {
      "description": "A polygon with a factor, or a grey picture stretched over the puppet's picture.",
      "type": "object",
      "if": { "required": ["image"] },
      "then": {
        "properties": {
          "image": {
            "description": "Path of the picture: black is 1, white is max.",
            "type": "string",
            "minLength": 1
          },
          "max": { "description": "Factor where the picture is white.", "$ref": "#/$defs/stiffness_factor" }
        },
        "required": ["max"]
      },
      "else": {
        "properties": {
          "points": { "description": "Where the factor applies.", "$ref": "#/$defs/polygon" },
          "value": { "description": "The factor inside.", "$ref": "#/$defs/stiffness_factor" }
        },
        "required": ["points", "value"]
      }
    },
    "method": {
      "description": "How the mesh follows the handles.",
      "type": "object",
      "properties": {
        "name": { "description": "As --method of the command.", "enum": [], "default": "arap" },
        "arap_energy": {
          "description": "Of arap: which edges share a rotation.",
          "enum": ["elements", "spokes", "spokes-and-rims"],
          "default": "elements"
        },
        "bending_length_px": {
          "description": "Of smooth-arap: pixels that bend together. Absent: 1/50 of the subject's diagonal.",
          "type": "number",
          "exclusiveMinimum": 0
        },
        "stretching": {
          "description": "Of thin-shell: against stretching.",
          "type": "number",
          "minimum": 0,
          "default": 1
        },
        "bending": {
          "description": "Of thin-shell: against bending, as a share of the subject's squared diagonal.",
          "type": "number",
          "minimum": 0,
          "default": 0.01
        },
        "tolerance": {
          "description": "Iterative methods stop at this relative change of energy.",
          "type": "number",
          "exclusiveMinimum": 0,
          "default": 1e-8
        },
        "max_iterations": {
          "description": "Iterative methods stop after so many, not converged.",
          "type": "integer",
          "minimum": 1,
          "maximum": 2147483647,
          "default": 1000
        },
        "weights": {
          "description": "Of fast, lbs, dual-complex, intrinsic: how much vertices follow each handle.",
          "enum": [],
          "default": "bbw"
        },
        "partition": {
          "description": "Of bbw weights: they sum to 1 within the minimisation, or by division afterwards.",
          "enum": ["coupled", "normalised"],
          "default": "coupled"
        },
        "l1_budget": {
          "description": "Of l1 weights: largest integral of a weight, as a share of what it has without.",
          "type": "number",
          "exclusiveMinimum": 0,
          "maximum": 1,
          "default": 0.8
        }
      }
    },
    "pose": {
      "description": "Where the handles go. A handle that is not named stays where it rests.",
      "type": "object",
      "properties": {
        "name": {
          "description": "Names the pose; rest is kept for the rest pose.",
          "type": "string",
          "minLength": 1,
          "not": { "const": "rest" }
        },
        "time_s": { "description": "When an animation arrives here, seconds.", "type": "number", "default": 0 },
        "handles": {
          "description": "By the ids of the handles.",
          "type": "object",
          "additionalProperties": { "$ref": "#/$defs/handle_pose" }
        }
      },
      "required": ["name"]
    },
    "turn": {
      "description": "Degrees, clockwise on screen, whole turns counted.",
      "type": "number",
      "minimum": -360000,
      "maximum": 360000
    },
    "matrix_entry": { "type": "number", "minimum": -1000000, "maximum": 1000000 },
    "handle_pose": {
      "description": "Where one handle goes. Which keys it can have depends on its type.",
      "type": "object",
      "properties": {
        "to": {
          "description": "Target of a point, vertex, bone's end, region's centroid; one for each corner of a cage.",
          "type": "array",
          "if": { "items": { "type": "array" }, "minItems": 1 },
          "then": { "$ref": "#/$defs/polygon" },
          "else": { "$ref": "#/$defs/point" }
        },
        "from": { "description": "Target of a bone's start.", "$ref": "#/$defs/point" },
        "rotate_deg": {
          "description": "Turns a point (absent: free), a region, a bone about its start; not beside a bone's to.",
          "$ref": "#/$defs/turn"
        },
        "turn_deg": {
          "description": "Of a point whose angle is free: how far it turned on its way here.",
          "$ref": "#/$defs/turn"
        },
        "scale": {
          "description": "Scales a point (absent: free), a region, a bone; not beside a bone's to.",
          "type": "number",
          "exclusiveMinimum": 0,
          "maximum": 1000000
        },
        "reach": {
          "description": "Of a bone: where its end comes by bending it and its parents.",
          "$ref": "#/$defs/point"
        },
        "chain": {
          "description": "How many bones bend to reach; it and its parents.",
          "type": "integer",
          "minimum": 1,
          "maximum": 2147483647,
          "default": 2
        },
        "depth": {
          "description": "Which part is drawn over which: larger is nearer to the viewer.",
          "type": "number",
          "minimum": -1000000,
          "maximum": 1000000,
          "default": 0
        },
        "affine": {
          "title": "six numbers [a, b, c, d, e, f]",
          "description": "Instead of all else: x' = a x + c y + e, y' = b x + d y + f.",
          "type": "array",
          "prefixItems": [
            { "$ref": "#/$defs/matrix_entry" },
            { "$ref": "#/$defs/matrix_entry" },
            { "$ref": "#/$defs/matrix_entry" },
            { "$ref": "#/$defs/matrix_entry" }
          ],
          "items": { "type": "number" },
          "minItems": 6,
          "maxItems": 6
        }
      },
      "dependentRequired": { "chain": ["reach"] },
      "allOf": [
        {
          "if": { "required": ["reach"] },
          "then": { "properties": { "to": false, "rotate_deg": false, "affine": false } }
        },
        {
          "if": { "required": ["affine"] },
          "then": { "properties": { "to": false, "from": false, "rotate_deg": false, "scale": false } }
        }
      ]
    }
  }
})schema";

}  // namespace

Json json_of_puppet_schema() {
    Json schema = Json::parse(schema_text);
    Json& method = schema["$defs"]["method"]["properties"];
    method["name"]["enum"] = method_names();
    method["weights"]["enum"] = weight_kind_names();
    return schema;
}

std::string puppet_schema() {
    return json_of_puppet_schema().dump(2) + "\n";
}

}  // namespace puppetwarp
