"""The kinds of input: a file in one role of one verb, and the command that reads it."""
import dataclasses


@dataclasses.dataclass(frozen=True)
class Kind:
    """A file, its form (see `mutations.FORMS`), and the command that reads it."""
    name: str
    form: str
    file: str
    command: str
    usage: bool = False  # Whether the file holds options, whose values may be wrong usage or ask for much work.
    others: tuple = ()  # Further inputs that a message may name, since it is about what two files say together.

    @property
    def words(self):
        return self.command.split()


# What a file leads to that no command names.
NEEDS = {"site.json": ["site.ground"], "moving.json": ["site.ground", "path.txt"], "table.yaml": ["table.csv"],
         "tree.gltf": ["tree.bin"], "rig.yaml": ["spinning.yaml"], "chain.yaml": ["spinning.yaml"]}

SIMULATE = "simulate model --sensor spinning.yaml --trajectory poses.txt"
KINDS = [
    # Logs
    Kind("info.log", "header", "log.ply", "info log.ply"),
    Kind("info.leaves", "header", "labelled.ply", "info labelled.ply --leaves vegetation"),
    Kind("info.echoes", "header", "echoes.ply", "info echoes.ply"),
    Kind("split.log", "header", "log.ply", "split log.ply --columns 4 --train train.ply --test test.ply"),
    Kind("split.echoes", "header", "echoes.ply", "split echoes.ply --every 2 --train train.ply --test test.ply"),
    Kind("fit.log", "header", "log.ply", "fit log.ply -o out --ground-spacing 2 --min-points 4"),
    Kind("fit.ray-cloud", "header", "cloud.ply", "fit cloud.ply -o out --fitter voxel --ground-spacing 2"),
    Kind("fit.surface", "header", "log.ply", "fit log.ply -o out --fitter surface --surface-cell 1 --ground-spacing 2"),
    Kind("optimize.log", "header", "log.ply", "optimize log.ply -o out.yaml --budget 1 --ground-spacing 2"),
    Kind("segment.log", "header", "log.ply", "segment log.ply -o out.ply --min-points 5"),
    Kind("extract.labelled", "header", "labelled.ply", "extract model labelled.ply -o out", others=("model",)),
    Kind("annotate.labelled", "header", "labelled.ply", "annotate labelled.ply -o out.json --ground-spacing 2"),
    Kind("simulate.like", "header", "log.ply", "simulate model --like log.ply -o out.ply"),
    Kind("score.real", "header", "log.ply", "score log.ply simulated.ply --json out.json", others=("simulated.ply",)),
    Kind("score.simulated", "header", "simulated.ply", "score log.ply simulated.ply --json out.json",
         others=("log.ply",)),
    # Lists of objects
    Kind("perceive.log", "header", "log.ply", "perceive log.ply --pipeline real -o out.json"),
    Kind("perceive.boxes", "text", "boxes.csv", "perceive log.ply --truth boxes.csv -o out.csv", others=("log.ply",)),
    Kind("perceive.truth", "json", "objects.json", "perceive log.ply --truth objects.json -o out.csv",
         others=("log.ply",)),
    Kind("osi.views", "bytes", "views_sv_.osi", "osi convert views_sv_.osi -o out.ply"),
    Kind("osi.replay", "bytes", "views_sv_.osi", "osi replay views_sv_.osi --chain chain.yaml -o out.osi"),
    Kind("osi.data", "bytes", "data_sd_.osi", "osi convert data_sd_.osi -o out.json"),
    Kind("osi.chain", "yaml", "chain.yaml", "osi replay views_sv_.osi --chain chain.yaml -o out.osi", usage=True,
         others=("views_sv_.osi",)),
    Kind("score.objects-csv", "text", "objects.csv", "score objects.csv objects.json", others=("objects.json",)),
    Kind("score.objects-json", "json", "objects.json", "score objects.csv objects.json", others=("objects.csv",)),
    Kind("simulate.rig", "yaml", "rig.yaml", "simulate model --rig rig.yaml --trajectory poses.txt -o out.ply",
         others=("poses.txt",)),
    # What import reads
    Kind("import.ray-cloud", "header", "cloud.ply", "import cloud.ply -o out.ply"),
    Kind("import.ply-ascii", "text", "points-ascii.ply", "import points-ascii.ply -o out.ply"),
    Kind("import.ply-little", "header", "points-little.ply", "import points-little.ply -o out.ply"),
    Kind("import.ply-big", "header", "points-big.ply", "import points-big.ply -o out.ply"),
    Kind("import.pcd-ascii", "text", "points-ascii.pcd", "import points-ascii.pcd -o out.ply"),
    Kind("import.pcd-binary", "header", "points-binary.pcd", "import points-binary.pcd -o out.ply"),
    Kind("import.pcd-compressed", "header", "points-compressed.pcd", "import points-compressed.pcd -o out.ply"),
    Kind("import.npy", "header", "points.npy", "import points.npy -o out.ply"),
    Kind("import.npz", "bytes", "points.npz", "import points.npz -o out.ply"),
    Kind("import.csv-beams", "text", "log.csv", "import log.csv -o out.ply"),
    Kind("import.csv-points", "text", "points.csv", "import points.csv -o out.ply"),
    Kind("import.bin", "bytes", "000000.bin", "import 000000.bin -o out.ply"),
    Kind("import.labels", "bytes", "points.label", "import points-binary.pcd --labels points.label -o out.ply"),
    Kind("import.poses-tum", "text", "poses.txt", "import drive --poses poses.txt -o out.ply"),
    Kind("import.poses-timed", "text", "timed.txt", "import drive --poses timed.txt -o out.ply"),
    Kind("import.poses-kitti", "text", "kitti.txt", "import drive --poses kitti.txt -o out.ply"),
    Kind("import.times", "text", "times.txt", "import drive --times times.txt -o out.ply",
         others=("drive",)),
    Kind("import.kitti-scan", "bytes", "drive/velodyne/000001.bin", "import drive -o out.ply"),
    Kind("import.kitti-poses", "text", "drive/poses_velo.txt", "import drive -o out.ply"),
    Kind("import.kitti-times", "text", "drive/times.txt", "import drive -o out.ply"),
    Kind("import.kitti-name", "name", "drive/velodyne/000001.bin", "import drive -o out.ply"),
    Kind("import.odometry-calib", "text", "odometry/calib.txt", "import odometry -o out.ply"),
    Kind("import.odometry-poses", "text", "odometry/poses.txt", "import odometry -o out.ply"),
    Kind("import.odometry-labels", "bytes", "odometry/labels/000000.label", "import odometry -o out.ply"),
    Kind("import.raw-oxts", "text", "raw/oxts/data/0000000001.txt", "import raw -o out.ply"),
    Kind("import.raw-stamps", "text", "raw/velodyne_points/timestamps.txt", "import raw -o out.ply"),
    Kind("import.raw-oxts-stamps", "text", "raw/oxts/timestamps.txt", "import raw -o out.ply"),
    Kind("import.raw-calib", "text", "raw/calib_imu_to_velo.txt", "import raw -o out.ply"),
    Kind("import.folder-scan", "header", "folder/000001.pcd", "import folder -o out.ply"),
    Kind("import.folder-name", "name", "folder/000001.pcd", "import folder -o out.ply"),
    Kind("import.sensor", "yaml", "spinning.yaml",
         "import drive --infer-misses spinning.yaml --deskew spinning.yaml -o out.ply", others=("drive",)),
    # Labels
    Kind("segment.label-file", "bytes", "cloud.label", "segment cloud.ply -o out.ply --labels cloud.label "
         "--label-set semantickitti", others=("cloud.ply",)),
    Kind("segment.label-csv", "text", "label.csv",
         "segment log.ply -o out.ply --labels label.csv --label-set semantickitti",
         others=("log.ply",)),
    Kind("segment.label-ply", "header", "labelled.ply", "segment log.ply -o out.ply --labels labelled.ply",
         others=("log.ply",)),
    # Models
    Kind("info.model-json", "json", "model/model.json", "info model"),
    Kind("simulate.model-json", "json", "model/model.json", "simulate model --like log.ply -o out.ply"),
    Kind("simulate.ground", "header", "model/ground.ply", "simulate model --like log.ply -o out.ply"),
    Kind("simulate.ellipsoids", "header", "model/ellipsoids.ply", "simulate model --like log.ply -o out.ply"),
    Kind("simulate.surface", "header", "mesh/surface.ply", "simulate mesh --like log.ply -o out.csv"),
    Kind("extract.model-json", "json", "model/model.json", "extract model labelled.ply -o out"),
    Kind("score.model-json", "json", "model/model.json",
         "score log.ply simulated.ply --model model --json out.json"),
    Kind("fit.start-json", "json", "model/model.json",
         "fit log.ply -o out --fitter likelihood --start model --rounds 1 --ground-spacing 2"),
    Kind("fit.start-ellipsoids", "header", "model/ellipsoids.ply",
         "fit log.ply -o out --fitter likelihood --start model --rounds 1 --ground-spacing 2"),
    # Annotations, sets of primitives, scenes
    Kind("compose.annotation", "json", "site.json", "compose site.json primitives -o out", others=("",)),
    Kind("compose.trajectory", "text", "path.txt", "compose moving.json primitives -o out"),
    Kind("compose.ground", "header", "site.ground/ground.ply", "compose site.json primitives -o out"),
    Kind("compose.primitives-json", "json", "primitives/primitives.json", "compose site.json primitives -o out"),
    Kind("compose.primitive-json", "json", "primitives/large_shrub/0001/model.json",
         "compose site.json primitives -o out"),
    Kind("compose.primitive-ellipsoids", "header", "primitives/large_shrub/0001/ellipsoids.ply",
         "compose site.json primitives -o out"),
    Kind("optimize.annotation", "json", "site.json",
         "optimize log.ply -o out.yaml --annotation site.json --primitives primitives --budget 1", others=("",)),
    Kind("optimize.checkpoint", "json", "state.json",
         "optimize log.ply -o out.yaml --budget 3 --ground-spacing 2 --checkpoint state.json --resume"),
    Kind("info.scene-json", "json", "scene/scene.json", "info scene"),
    Kind("simulate.scene-json", "json", "moving/scene.json", "simulate moving --like log.ply -o out.pcd"),
    Kind("simulate.instances", "header", "scene/instances.ply",
         "simulate scene --like log.ply -o out.ply --element-ids"),
    Kind("simulate.scene-movers", "text", "moving/movers/0000.txt", "simulate moving --like log.ply -o out.ply"),
    Kind("simulate.scene-model", "json", "scene/models/0001/model.json", "simulate scene --like log.ply -o out.ply"),
    # Sensors, materials, trajectories
    Kind("sensors.spinning", "yaml", "spinning.yaml", "sensors show spinning.yaml --plot out.svg",
         others=("",)),
    Kind("sensors.raster", "yaml", "raster.yaml", "sensors show raster.yaml", others=("",)),
    Kind("sensors.echo", "yaml", "spinning.yaml",
         "sensors echo spinning.yaml --target 10:leaf:0.4 --target 12:soil --csv out.csv", others=("",)),
    Kind("sensors.directions", "text", "table.csv", "sensors show table.yaml"),
    Kind("simulate.sensor", "yaml", "spinning.yaml", SIMULATE + " --super-sample sensor -o out.ply",
         others=("",)),
    Kind("simulate.directions-sensor", "yaml", "table.yaml",
         "simulate model --sensor table.yaml --trajectory poses.txt -o out/", others=("",)),
    Kind("simulate.directions", "text", "table.csv",
         "simulate model --sensor table.yaml --trajectory poses.txt -o out.ply"),
    Kind("simulate.trajectory", "text", "poses.txt", SIMULATE + " -o out --profile ouster"),
    Kind("simulate.materials", "yaml", "materials.yaml",
         SIMULATE + " --super-sample 2 --materials materials.yaml -o out.ply --waveforms waves.csv"),
    Kind("simulate.mover-poses", "text", "path.txt",
         "simulate model --like log.ply --mover tree.obj:path.txt -o out.ply"),
    Kind("simulate.mover-mesh", "text", "tree.obj",
         "simulate model --like log.ply --mover tree.obj:path.txt -o out.ply"),
    # Meshes
    Kind("meshes.obj", "text", "tree.obj", "meshes tree.obj -o out --sizes 1 --up y"),
    Kind("meshes.ply-ascii", "text", "tree.ply", "meshes tree.ply -o out --sizes 1 --up z"),
    Kind("meshes.ply-binary", "header", "binary.ply", "meshes binary.ply -o out --sizes 1"),
    Kind("meshes.gltf", "json", "tree.gltf", "meshes tree.gltf -o out --sizes 1"),
    Kind("meshes.gltf-buffer", "bytes", "tree.bin", "meshes tree.gltf -o out --sizes 1", others=("tree.gltf",)),
    Kind("meshes.gltf-inline", "json", "inline.gltf", "meshes inline.gltf -o out --sizes 1"),
    Kind("meshes.glb", "glb", "tree.glb", "meshes tree.glb -o out --sizes 1"),
    # Configurations
    Kind("fit.config", "yaml", "fit-options.yaml", "fit log.ply -o out --config fit-options.yaml", True, ("",)),
    Kind("segment.config", "yaml", "segment-options.yaml", "segment log.ply -o out.ply --config segment-options.yaml",
         True, ("",)),
    Kind("compose.config", "yaml", "compose-options.yaml",
         "compose site.json primitives -o out --config compose-options.yaml", True, ("",)),
    Kind("simulate.config", "yaml", "simulate-options.yaml", SIMULATE + " -o out.ply --config simulate-options.yaml",
         True, ("",)),
]
