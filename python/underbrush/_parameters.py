"""The options of verbs; python/tests/make_parameters.py writes this file."""
from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TypedDict


class FitParameters(TypedDict, total=False):
    """Options of `fit`, as docs/reference/parameters.md lists them."""

    fitter: str  #: How the model is made (default likelihood).
    min_range: float  #: Leave out nearer returns (of the own vehicle) (m; default 0).
    tile: float  #: Side of a tile; memory grows with it (m; default 32).
    ranges_as_given: bool  #: Learn no range offsets of the sensor's channels (default false).
    clusters_per_point: float  #: Number of ellipsoids per point (default 0.1).
    min_points: int  #: Least number of points of an ellipsoid (default 3).
    #: Rounds of expectation and maximisation in which ellipsoids share the points at the borders of clusters
    #: (default 2).
    mixture_rounds: int
    voxel_side: float  #: Side of a voxel (0.05 suits a standing scanner) (m; default 0.3).
    voxel_bounded: bool  #: A beam meets a Gaussian only within the Gaussian's own voxel (default false).
    top_down_min_points: int  #: Least number of points of each half of a cluster that is split (default 10).
    bottom_up_cell: float  #: Side of the cubes whose points make the first clusters (m; default 0.1).
    surface_cell: float  #: Cell of the marching cubes (m; default 0.1).
    surface_kernel: float  #: Radius of the kernel (m; default 0.8).
    surface_least_kernel: float  #: Radius down to which the kernel is halved where points are dense (m; default 0.2).
    #: Largest offset of the points' mean from the surface; the surface has a hole where it is larger (kernels;
    #: default 0.3).
    surface_border: float
    #: Standard deviation of the simulated range; 0 = that of the residuals along the beams (m; default 0).
    surface_noise: float
    surface_carve: bool  #: Leave out triangles that most beams passed (default false).
    ground_method: str  #: Ground segmentation (default lower_envelope).
    ground_spacing: float  #: Least distance of the nodes of the ground's height map (m; default 0.5).
    ground_smoothness: float  #: Weight of bending of the ground's height map (m²; default 0.05).
    ground_error: float  #: Largest distance of the ground mesh from the height map (m; default 0.01).
    tau: float  #: Mahalanobis distance within which a beam meets an ellipsoid (default 3).
    max_residual_for_hit: float  #: Distance below which a triangle explains a point (m; default 0.75).
    #: Weight of the usual size of ellipsoids, as a prior of each covariance (points; default 1).
    covariance_prior: float
    ellipsoid_prior_hits: float  #: Prior hits of an ellipsoid (default 0).
    ellipsoid_prior_misses: float  #: Prior misses of an ellipsoid (default 0).
    #: Drop ellipsoids whose hits came within a short time and whose share of hits, hits / (hits + misses), is below
    #: this (default 0.2).
    free_space_below: float
    range_noise: float  #: The sensor's range noise (m; default 0.02).
    triangle_prior_hits: float  #: Prior hits of a triangle; likelihood has 10 (default 10000).
    triangle_prior_misses: float  #: Prior misses of a triangle (default 0).
    credit: str  #: The rule that credits elements with the hits and misses of beams (default first).
    start: str  #: The fitter to begin with, or the folder of a model (default hierarchical).
    rounds: int  #: Largest number of M-steps (default 5).
    #: Number k of parameters fitted to the n points of each ellipsoid of the start; its variances grow by (n + k) /
    #: (n - k) (default 2).
    spent_at_start: float
    #: Assumed probability that a return is lost, so that a single miss does not make the elements that the beam met
    #: permeable (default 0.001).
    dropout: float
    #: Exponent on the probabilities of the final model; above 1, draws have smaller errors, and the likelihood is
    #: worse (default 1).
    sharpness: float
    #: Keep scans as range images (keyframes), at most 16 within this distance; simulated beams near them use their
    #: pixels; 0 = none (m; default 2).
    keyframes: float
    #: Side of the cells of the map of observed space; in unknown space, which no beam crossed, simulated beams end
    #: with a density that is learnt from the log; 0 = unknown space is empty (m; default 1).
    unknown_cell: float


class SimulateParameters(TypedDict, total=False):
    """Options of `simulate`, as docs/reference/command-line.md lists them."""

    actors: str | os.PathLike[str]  #: Add things that move: a folder that actors wrote, or a list of edits of one.
    #: Add columns for the element at which each beam ended and for its class; for a scene also for its instance
    #: (default false).
    element_ids: bool
    beams: str  #: Answer only the beams FIRST to END - 1, numbered from 0, as they are answered among all.
    memory: str  #: Memory for the regions of a world that are open at a time (default 2GiB).
    #: Trace several sub-rays in each beam and compute light, waveform and echoes: a number, COLUMNSxROWS, or sensor
    #: for the number in the sensor's data file.
    super_sample: str
    returns: str  #: The echoes that are reported: strongest, first, last, or up to N (default: the sensor's).
    #: Whether leaves and stones are drawn once, so that neighbouring beams and later scans meet the same ones, or
    #: anew for each beam; still is once also where those of the model sway (default once).
    matter: str
    #: Size of the cells in which matter that is drawn once is all there or all absent; 0 = the model's (m; default
    #: 0).
    grain: float
    tau: float  #: Mahalanobis distance within which a beam meets an ellipsoid; 0 = the model's (default 0).
    #: Correlation time of leaves that sway; 0 = the model's, whose leaves stand still unless its log shows
    #: otherwise (s; default 0).
    wind: float
    support: bool  #: Add a column with the probability that a beam does not end in unknown space (default false).
    #: How the range in an ellipsoid is drawn: along the beam, or in the ellipsoid's volume; median takes the median
    #: of the beam's distribution, which has the least error (default on_ray).
    draw: str
    #: Whether a return has the expected intensity of its element, or one that is drawn with the element's spread;
    #: for models of logs with intensities (default mean).
    intensity: str
    beam: str  #: Whether the ray is traced on the beam's axis, or drawn from the sensor's cone (default thin).
    max_range: float  #: Maximum range; 0 = the log's or the sensor's (m; default 0).
    range_noise: float  #: Standard deviation of additional noise on every range (m; default 0).
    #: Trace all sub-rays of every beam; without it, beams of 26 or more are traced with 13 sub-rays where these
    #: agree (default false).
    all_sub_rays: bool
    materials: str | os.PathLike[str]  #: A table of materials that replaces the built-in one.
    material: Sequence[str]  #: The material of a class; may be repeated.
    visibility: float  #: Visibility in haze or fog; 0 = clear air (m; default 0).
    rain: float  #: Rain rate (mm/h; default 0).
    sun: float  #: Share of the sunlight that passes the air, which adds to the receiver's noise; 0 = night (default 0).
    waveform_every: int  #: Write the waveforms of beams 0, K, 2K, … (default 1).
    waveform_count: int  #: Largest number of waveforms in tables and plots (default 100).
    waveforms: Sequence[str]  #: Files (.csv, .svg, .waves) for waveforms; not of Lidar.
    up: str  #: Axis that points up in the file of a mesh: y or z (default z).
    unit: float  #: Length of the unit of the file of a mesh (m; default 1).
    assets: str  #: Folder in which a scene of HELIOS++ has its files, besides its own.


class ImportParameters(TypedDict, total=False):
    """Options of `import`, as docs/reference/command-line.md lists them."""

    format: str  #: Format of the source (default: detected).
    poses: str | os.PathLike[str]  #: File of the sensor's poses, in TUM or KITTI format.
    times: str | os.PathLike[str]  #: File of the scans' times, one on each line, s.
    labels: str | os.PathLike[str]  #: Labels of a single scan, a SemanticKITTI .label file.
    label_set: str  #: Label set of the column class (default: semantickitti for .label files).
    keep: str  #: Read only the points with this value of a column, such as first returns: target_index=1.
    columns: str  #: Names of the columns of a .bin or text file that does not say them: x,y,z,intensity,ring.
    unit: str  #: Unit of the coordinates of scans (default m).
    assets: str | os.PathLike[str]  #: Folder in which a survey of HELIOS++ has its files, besides its own.
    frames: str  #: Scans to read, by number, half-open: A:B or A:B:STEP.
    deskew: str  #: Give every beam its own pose by this sensor's timing, for raw scans.
    times_as_given: bool  #: With --deskew: fit no clock to scan times that were rounded (default false).
    #: Leave out beams without a return that point lower than this elevation, as at the own vehicle; by default
    #: inferred ones below -13 and no recorded ones.
    unknown_below_deg: float
    #: Turn every beam up by this angle, for a known fault of the recording (KITTI: 0.205) (default 0).
    elevation_offset_deg: float
    infer_misses: str  #: Infer misses from this sensor's scan pattern, for formats that drop them.
    max_range: float  #: Range of a miss; 0 = the sensor's or the log's own (m; default 0).
    #: The points are in the world frame already, and the poses only give the place of the sensor (default false).
    points_in_world: bool


class SplitParameters(TypedDict, total=False):
    """Options of `split`, as docs/reference/command-line.md lists them."""

    every: int  #: Every K-th scan.
    #: Every K-th column of each scan: the beams fired at one time (where the log has no times of beams: in one
    #: packet).
    columns: int
    time: Sequence[float]  #: Scans whose time lies in [FROM, TO), s after the log's start.
    region: Sequence[float]  #: Scans whose sensor stands in this rectangle of the world, m.
    offset: int  #: With --every and --columns: number (mod K) that is held out (default 1).


class SegmentParameters(TypedDict, total=False):
    """Options of `segment`, as docs/reference/command-line.md lists them."""

    #: Take labels from this file: a SemanticKITTI .label file, or a PLY, PCD or CSV file with a column class or
    #: instance (also the log itself).
    labels: str | os.PathLike[str]
    label_set: str  #: Label set that gives the numbers of --labels their meaning.
    truth: str  #: Column of the log with the numbers of the true trees, to score against (default instance).
    ground_method: str  #: Method of ground segmentation (default lower_envelope).
    min_range: float  #: Ignore hits nearer than this, m, such as those on the own vehicle (default 0).
    tile: float  #: Side of a tile of the ground segmentation (m; default 32).
    cell: float  #: Side of a column; 0 = 0.4, more where points are sparse (m; default 0).
    gap: float  #: Empty height that separates objects in a column; 0 = by the column's side (m; default 0).
    min_points: int  #: Least number of points of an object (default 10).
    spacing: float  #: Treat peaks nearer to each other than this as one crown; grows with height (m; default 1.2).
    prominence: float  #: Join crowns whose dip between them is less deep than this; grows with height (m; default 0.3).
    radius: float  #: Largest reach of a crown from its peak; grows with height (m; default 1.5).
    foot: float  #: Largest width of a tree's foot under its crown (m; default 1).
    tree_height: float  #: Least height of a tree; lower objects are shrubs (m; default 3).
    small_shrub_height: float  #: Least height of a small shrub; lower ones are low shrubs (m; default 0.5).
    medium_tree_height: float  #: Least height of a medium tree; lower ones are small trees (m; default 6).
    large_tree_height: float  #: Least height of a large tree; lower ones are medium trees at most (m; default 10).
    patch_side: float  #: Least length of a patch of shrubs (m; default 4).


class MoversParameters(TypedDict, total=False):
    """Options of `movers`, as docs/reference/command-line.md lists them."""

    #: Times before and after a scan at which other scans are compared with it (s; default
    #: 0.1,0.2,0.3,0.5,0.8,1.2,2,3,4.5,6).
    look_s: Sequence[float]
    least_empty: int  #: Number of the outermost scans in which the place of a mover must be empty (default 3).
    cell_deg: float  #: Width of the cells in which scans are compared (degrees; default 0.5).
    max_range: float  #: Largest range of the returns that may be marked (m; default 80).
    #: Largest difference of two ranges of one surface, to which 1 % of the range is added (m; default 0.3).
    same_m: float
    least_points: int  #: Returns of the smallest mover in a scan (default 12).


class ActorsParameters(TypedDict, total=False):
    """Options of `actors`, as docs/reference/command-line.md lists them."""

    margin: float  #: Returns up to this far outside of a box belong to its object (m; default 0.3).
    foot: float  #: Returns up to this height above the bottom of a box are those of the ground (m; default 0.15).
    least_returns: int  #: Leave out objects with fewer returns in all scans (default 30).
    walk: float  #: Time for which a pedestrian is rigid; each part of a walk has a model of its own (s; default 0.5).
    poses_as_given: bool  #: Keep the poses of the boxes instead of registering the scans of an object (default false).
    #: Leave the unseen side of vehicles and cyclists empty instead of mirroring the other side (default false).
    one_sided: bool


class ExtractParameters(TypedDict, total=False):
    """Options of `extract`, as docs/reference/command-line.md lists them."""

    #: Fit boxes to the points from this quantile to 1 − it along each axis; 0 = all points (0.05 in the code of
    #: [tallavajhula18]'s authors) (default 0).
    box_quantile: float
    #: Elements that an object takes: all those centred in its box, or only its own, which lie among its points
    #: (default own).
    elements: str
    #: Leave out ellipsoids at which a smaller share of the beams that met them ended (default 0).
    free_space_below: float
    patch_cell: float  #: Side of the cells that patches of shrubs are cut into (m; default 2).
    min_elements: int  #: Leave out objects and cells with fewer elements (default 1).
    min_points: int  #: Leave out objects and cells with fewer points (default 5).


class ComposeParameters(TypedDict, total=False):
    """Options of `compose`, as docs/reference/command-line.md lists them."""

    #: Primitive of its class that an object gets: the one with the nearest box; the one that fits best, adapted to
    #: where the object's points lie and how many beams it stops, and no plant twice within 20 m if others fit; or
    #: any (default best).
    choose: str
    nearest: int  #: Draw each primitive among this many that fit best (default 1).
    scale: bool  #: Scale primitives to their boxes (default false).
    #: Use no primitive that was cut from an object whose box overlaps one of this annotation, as seen from above.
    leave_out: Sequence[str]
    allow_outside: bool  #: Follow paths of the annotation that lead out of its folder (default false).
    strict: bool  #: Fail if an object cannot be placed as annotated (default false).


class PerceiveParameters(TypedDict, total=False):
    """Options of `perceive`, as docs/reference/command-line.md lists them."""

    #: The true objects: labelled boxes in the sensor's frame (CSV with frame and track_id), or lists of objects in
    #: the world's frame (CSV, JSON, or an OSI trace).
    truth: str | os.PathLike[str]
    pipeline: str  #: The tracking model, which assigns points by the truth, or a real pipeline (default model).
    rig: str | os.PathLike[str]  #: The sensors of the vehicle, for a log of several.
    min_range: float  #: Ignore hits nearer than this, m, such as those on the own vehicle (default 0).
    #: Height of the sensor above the ground, on which the vehicle's frame stands; the file of a rig has the heights
    #: of its sensors (m; default 0).
    sensor_height: float
    truth_elevation_deg: float  #: Turn labelled boxes up by this angle, as import turned the beams (default 0).
    no_deskew: bool  #: Ignore the vehicle's motion within a cycle (default false).
    #: When an object is listed: by its probability, after --needed cycles in a row with points, or after --needed
    #: of --window cycles (default probability).
    existence: str
    gain: float  #: Probability that a cycle with points adds (default 0.2).
    loss: float  #: Probability that a cycle without points subtracts (default 0.055).
    threshold: float  #: Probability from which on an object is listed (default 0.5).
    start_points: int  #: An object that is not listed needs more points than this number (default 3).
    full_extent: float  #: Segments that are smaller than this add less; 0 = all add the same (m; default 0).
    needed: int  #: Cycles with points (default 5).
    window: int  #: Cycles among which they are counted (default 10).
    #: Cycles without points after which an object is dropped, with --existence in-a-row or out-of (default 10).
    lost: int
    reference: str  #: The point that is tracked (default corner).
    heading: str  #: Where the tracking model takes headings from (default points).
    as_measured: bool  #: Report boxes as the points show them, not completed by the sizes of the class (default false).
    ground: str  #: Ground removal of the real pipeline (default cone).
    latency_ms: float  #: Time from a cloud to its list (ms; default 0).
    #: Merge objects of the tracking model that are nearer to each other than the sensor resolves (default false).
    merge_close: bool
    merge_gap: float  #: Distance below which objects are always merged (m; default 0.3).
    ghosts_per_s: float  #: Objects that do not exist, in each second (default 0).
    ghost_life: float  #: Mean life of such an object (s; default 0.5).
    cell: float  #: Side of a cell (m; default 0.2).
    half_side: float  #: Distance that the grid reaches from the vehicle along x and y (m; default 40).
    low: float  #: Matter counts from this height above the ground on (m; default 0.2).
    high: float  #: Matter counts up to this height (m; default 2).
    memory: float  #: Share of the evidence that stays from cycle to cycle (default 0.9).
    label_probability: float  #: A cell that no state fills with this probability is unknown (default 0.6).
