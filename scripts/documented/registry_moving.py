"""The tables of a drive in which things move: lists of objects, marked returns, and actors."""
from . import matter
from .common import BASELINES, HALVES, LOGS, cell, study
from .jobs import Job, Measured, Part, read_json


def sequential(folder):
    f = read_json(folder / "study.json")["figures"]["kitti_0005_tracks"]
    for row in ("truth", "meshes/model", "meshes/pipeline", "ellipsoids/model", "ellipsoids/pipeline", "noisy truth"):
        for value, error in matter.object_list_errors(f, row).items():
            yield row, value, [error]


#: The commands that make log.ply of the labelled drive, and what they need of DATA.
TRACKS = """mkdir -p drive/velodyne
"$PYTHON" "$DATA/frames.py" unpack "$DATA/kitti_0005_city/velodyne.kfx" drive/velodyne
"$PYTHON" "$DATA/frames.py" unpack "$DATA/kitti_0005_tracks/velodyne_30_89.kfx" drive/velodyne
underbrush import drive --poses "$DATA/kitti_0005_tracks/poses_velo.txt" --times "$DATA/kitti_0005_tracks/times.txt" \\
  --deskew velodyne-hdl64e --elevation-offset-deg 0.205 --infer-misses velodyne-hdl64e -o log.ply
rm -r drive
"""
TRACKS_NEEDS = ("kitti_0005_city/velodyne.kfx", "kitti_0005_tracks/velodyne_30_89.kfx")
SEQUENTIAL = study("sequential", "--data data", f"""{TRACKS}mkdir -p data/kitti_0005_tracks
mv log.ply data/kitti_0005_tracks/
cp "$DATA/kitti_0005_tracks/objects.csv" data/kitti_0005_tracks/
""", needs=TRACKS_NEEDS)

MOVERS = Job("movers.kitti_0005_tracks", f"""{TRACKS}underbrush movers log.ply \\
  --truth "$DATA/kitti_0005_tracks/objects.csv" --truth-elevation-deg 0.205 --json movers.json
rm log.ply
""", TRACKS_NEEDS)
MOVERS_FOREST = Job("movers.kitti_0027_forest", """underbrush movers "$WORK/kitti_0027_forest/log.ply" -o marked.ply \\
  --json movers.json
rm marked.ply
""", (LOGS["kitti_0027_forest"],), (HALVES["kitti_0027_forest"],))


def movers(folder):
    truth = read_json(folder / "movers.json")["truth"]
    for kind in ("moving", "standing"):
        for name, counts in truth[kind].items():
            yield f"{kind} {name}", "returns", [counts["returns"]]
            yield f"{kind} {name}", "marked", [counts["marked"]]
    yield "in no labelled box", "returns", [truth["elsewhere"]["returns"]]
    yield "in no labelled box", "marked", [truth["elsewhere"]["marked"]]


def movers_forest(folder):
    counts = read_json(folder / "movers.json")
    yield "a drive through a forest", "returns", [counts["returns"]]
    yield "a drive through a forest", "marked", [counts["marked"]]


#: The drive without its labelled objects, with them as boxes and as learnt actors, on the scans that were held out.
ACTORS = Job("actors.kitti_0005_tracks", f"""{TRACKS}underbrush split log.ply --every 2 --train train.ply --test test.ply
underbrush movers train.ply -o marked.ply
boxes="$DATA/kitti_0005_tracks/objects.csv" turned="--boxes-elevation-deg 0.205"
underbrush actors marked.ply --boxes "$boxes" $turned -o actors --marked static.ply --json actors.json
underbrush fit train.ply --min-range 2 -o ghosts
underbrush fit static.ply --min-range 2 -o world
"$PYTHON" "$SOURCE/scripts/box_actors.py" "$boxes" actors boxes.json
for class in all Van Cyclist Pedestrian; do
  [ $class = all ] && cp "$boxes" some.csv || grep -e ^frame -e ",$class," "$boxes" > some.csv
  underbrush actors test.ply --boxes some.csv $turned --met $class.ply
  for model in ghosts world; do underbrush simulate $model --like $class.ply -o $model.ply; done
  for kind in boxes.json actors; do
    underbrush simulate world --actors $kind --like $class.ply -o ${{kind%.json}}.ply
  done
  underbrush score $class.ply ghosts.ply world.ply boxes.ply actors.ply --train train.ply --json $class.json
  "$PYTHON" "$SOURCE/scripts/actor_pictures.py" $class.ply ghosts.ply actors.ply -o $class.png
done
underbrush actors test.ply --boxes "$boxes" $turned --marked others.ply
for model in ghosts world; do underbrush simulate $model --like others.ply -o $model.ply; done
underbrush score others.ply ghosts.ply world.ply --json others.json
edits() {{ echo '{{"format": "underbrush-actor-edits", "version": 1, "actors": "actors", "edits": ['"$2"']}}' > $1.json; }}
edits removed '{{"edit": "remove", "actor": "van-1"}}'
edits moved '{{"edit": "move", "actor": "van-1", "translation_m": [10, 0, 0]}}'
edits turned '{{"edit": "move", "actor": "cyclist-2", "yaw_rad": 3.141592653589793}}'
for list in actors removed.json moved.json turned.json; do
  underbrush simulate world --actors $list --like others.ply --element-ids --support -o ${{list%.json}}.ply
done
"$PYTHON" "$SOURCE/scripts/actor_edits.py" others.ply actors actors.ply van-1=removed.ply van-1=moved.ply \\
  cyclist-2=turned.ply > edits.json
rm -r *.ply ghosts world
""", TRACKS_NEEDS)
#: The same drive with all scans, whose moving objects are found without the labels.
ACTORS_FOUND = Job("actors-found.kitti_0005_tracks", f"""{TRACKS}underbrush actors log.ply -o found
underbrush actors log.ply --boxes "$DATA/kitti_0005_tracks/objects.csv" --boxes-elevation-deg 0.205 -o labelled
"$PYTHON" "$SOURCE/scripts/found_actors.py" labelled found > found.json
rm log.ply
""", TRACKS_NEEDS)
ACTOR_ROWS = {"ghosts": "ghosts in the world", "world": "left out", "boxes": "boxes", "actors": "actors"}
ACTOR_SCORES = {"capped error, m": "capped_error_m", "informedness": "informedness",
                "packet error, m": "packet_error_m", "recall of misses": "recall_of_misses",
                "precision of misses": "precision_of_misses",
                "median range error, m": "median_range_error_m", "cloud error, m": "cloud_error_m"}


def actors(folder):
    for group, row in (("all", "all"), ("Van", "vans"), ("Cyclist", "cyclist"), ("Pedestrian", "pedestrian")):
        read = read_json(folder / f"{group}.json")
        for model, words in {**ACTOR_ROWS, **{name: name for name in BASELINES}}.items():
            score = {**read["models"], **read["baselines"]}[model]
            for column, key in ACTOR_SCORES.items():
                yield f"{row}/{words}", column, cell(score, key)


def actors_found(folder):
    for name, row in read_json(folder / "found.json")["labelled"].items():
        for column, key in (("scans", "scans"), ("found in", "found"), ("as actors", "actors"),
                            ("distance, m", "distance_m")):
            yield name.rpartition("-")[0], column, [row[key]]


#: The scores of all beams of the scans that were held out but those that end at an actor.
STATIC_SCORES = {"packet error, m": "packet_error_m", "F1": "f1", "cloud error, m": "cloud_error_m",
                 "recall of misses": "recall_of_misses"}


def actors_static(folder):
    models = read_json(folder / "others.json")["models"]
    for model, words in (("ghosts", "all returns"), ("world", "without the actors")):
        for column, key in STATIC_SCORES.items():
            yield words, column, [models[model][key]]


EDIT_ROWS = {"removed": "the van is removed", "moved": "the van is 10 m ahead", "turned": "the cyclist is turned round"}
EDIT_COLUMNS = {"ended at it": "met", "end at it now": "met_edited", "freed": "behind",
                "return from known space": "known_returns", "near a return of another scan": "near_other_scans",
                "known to be free": "known_misses", "in unknown space": "unknown"}


def actor_edits(folder):
    edits = read_json(folder / "edits.json")
    for edit, words in EDIT_ROWS.items():
        for column, key in EDIT_COLUMNS.items():
            yield words, column, [edits[edit][key]]


def measured():
    """The tables of this file, by name."""
    return {"sequential": Measured((Part((SEQUENTIAL,), sequential),)),
            "actors": Measured((Part((ACTORS,), actors),)),
            "actors-found": Measured((Part((ACTORS_FOUND,), actors_found),)),
            "actors-static": Measured((Part((ACTORS,), actors_static),)),
            "actors-edits": Measured((Part((ACTORS,), actor_edits),)),
            "movers": Measured((Part((MOVERS,), movers), Part((MOVERS_FOREST,), movers_forest)))}
