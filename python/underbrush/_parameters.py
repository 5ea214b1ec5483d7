"""The options of verbs; python/tests/make_parameters.py writes this file."""
from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TypedDict


class FitParameters(TypedDict, total=False):
    """Options of `fit`, as docs/reference/parameters.md lists them."""

    fitter: str  #: How the model is made (default likelihood).
    min_range: float  #: Leave out nearer returns, as on the own vehicle (m; default 0).
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
    surface_cell: float  #: Side of the cells of the marching cubes (m; default 0.1).
    surface_kernel: float  #: Radius of the kernel that smooths the surface (m; default 0.8).
    surface_least_kernel: float  #: Radius down to which the kernel is halved where points are dense (m; default 0.2).
    #: Largest offset of the points' mean from the surface; the surface has a hole where the offset is larger
    #: (kernels; default 0.3).
    surface_border: float
    #: Standard deviation of the simulated range; 0 = the standard deviation of the residuals along the beams (m;
    #: default 0).
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
    range_noise: float  #: The sensor's range noise, at most (m; default 0.02).
    triangle_prior_hits: float  #: Prior hits of a triangle; likelihood has 10 (default 10000).
    triangle_prior_misses: float  #: Prior misses of a triangle (default 0).
    credit: str  #: The rule that credits elements with the hits and misses of beams (default first).
    effort: str  #: How much of a long log is used (default medium).
    start: str  #: The fitter to begin with, or the folder of a model (default hierarchical).
    rounds: int  #: Largest number of M-steps (default 5).
    #: Number k of parameters fitted to the n points of each ellipsoid of the start; its variances grow by (n + k) /
    #: (n - k) (default 2).
    spent_at_start: float
    #: Assumed probability that a return is lost; the greater it is, the more misses count as lost returns and not
    #: as passes through elements (default 0.001).
    dropout: float
    #: How certain the outcomes of the final model are: above 1, draws have smaller errors and the likelihood is
    #: worse; 1 = as fitted (default 1).
    sharpness: float
    #: Keep scans as range images (keyframes), at most 16 within this distance; simulated beams near them use their
    #: pixels; 0 = none (m; default 2).
    keyframes: float
    #: Side of the cells of the map of observed space; in unknown space, which no beam crossed, simulated beams end
    #: with a density that is learnt from the log; 0 = unknown space is empty (m; default 1).
    unknown_cell: float
    #: first = a beam ends at its first echo; all = each echo is treated as a beam, and hit probabilities are shares
    #: of the light (default first).
    echoes: str
    #: Fit a tile anew when the number of its returns has grown by this share since its last fit; 0 = always, so
    #: that the elements are those of one fit of all logs (default 0.25).
    growth: float
    logs: str | os.PathLike[str]  #: Folder that now holds the logs of the model.


class SimulateParameters(TypedDict, total=False):
    """Options of `simulate`, as docs/reference/command-line.md lists them."""

    actors: str | os.PathLike[str]  #: Add things that move: a folder that actors wrote, or a list of edits of one.
    #: Add columns for the element at which each beam ended and for its class; for a scene also for its instance
    #: (default false).
    element_ids: bool
    #: Simulate only the beams FIRST to END - 1; the first beam has the number 0. These beams get the same results
    #: as in a simulation of all beams.
    beams: str
    memory: str  #: Largest memory of the loaded regions of a world (default 2GiB).
    #: Trace several sub-rays in each beam and compute light, waveform and echoes: a number, COLUMNSxROWS, or sensor
    #: for the number in the sensor's data file.
    super_sample: str
    returns: str  #: The reported echoes: strongest, first, last, or up to N (default: those of the sensor).
    #: How leaves and stones are drawn at random: once = one draw for the whole simulation, so that neighbouring
    #: beams and later scans meet the same leaves, which sway if fit found that they do; still = the same without
    #: sway; anew = a new draw for each beam (default once).
    matter: str
    #: Side of the cells within which matter is drawn as one, unless it is drawn anew; 0 = as in the model (m;
    #: default 0).
    grain: float
    tau: float  #: Mahalanobis distance within which a beam meets an ellipsoid; 0 = as in the model (default 0).
    #: Correlation time of swaying leaves; 0 = the time that fit learnt, or no sway if it learnt none (s; default
    #: 0).
    wind: float
    support: bool  #: Add a column with the probability that a beam does not end in unknown space (default false).
    #: How the range of a beam is chosen: on_ray = at random along the beam; volumetric = at random in the volume of
    #: the ellipsoid; median = the median of the beam's distribution, which has the least error (default on_ray).
    draw: str
    #: The intensity of a return, for models of logs with intensities: mean = the expected intensity of the element;
    #: drawn = a random one with the spread of the element (default mean).
    intensity: str
    #: Where the ray of a beam is traced: thin = on the axis; random = in a random direction within the cone of the
    #: sensor's beam (default thin).
    beam: str
    max_range: float  #: Maximum range; 0 = that of the log or sensor (m; default 0).
    range_noise: float  #: Standard deviation of additional noise on every range (m; default 0).
    #: Trace all sub-rays of every beam; without this option, a beam of 26 or more sub-rays is computed from 13 of
    #: them where their ranges agree (default false).
    all_sub_rays: bool
    materials: str | os.PathLike[str]  #: A table of materials that replaces the built-in one.
    material: Sequence[str]  #: The material of a class; may be repeated.
    visibility: float  #: Visibility in haze or fog; 0 = clear air (m; default 0).
    rain: float  #: Rain rate (mm/h; default 0).
    sun: float  #: Share of the sunlight that passes the air, which adds to the receiver's noise; 0 = night (default 0).
    waveform_every: int  #: Write the waveforms of beams 0, K, 2K, … (default 1).
    waveform_count: int  #: Largest number of waveforms in tables and plots (default 100).
    #: Write digitised waveforms: some beams as a table (.csv) or a plot (.svg), or all beams as .waves; may be
    #: repeated.
    waveforms: Sequence[str]
    profile: str  #: Write a folder with a PCD file for each scan, in this driver's PointCloud2 layout.
    up: str  #: Axis that points up in mesh files; in glTF files it is always y (default z).
    unit: float  #: Length of the unit of mesh files (m; default 1).
    assets: str | os.PathLike[str]  #: Folder with the files of a scene of HELIOS++, besides the folder of the scene.


class ScoreParameters(TypedDict, total=False):
    """Options of `score`, as docs/reference/command-line.md lists them."""

    memory: str  #: Largest memory of the loaded regions of a world (default 2GiB).
    #: Other scores: kitti360 adds scores of range images of 66 x 1030 pixels, by which learned simulators are
    #: compared on KITTI-360; clouds compares logs that share no beams as point clouds.
    protocol: str
    #: Compare the scans that were recorded from one place: the change of ranges from scan to scan, and the distance
    #: of their bearing x range histograms (default false).
    repeats: bool


class OptimizeParameters(FitParameters, total=False):
    """Options of `optimize`, as docs/reference/command-line.md lists them."""

    #: What is minimised: packet_f1 = mean packet error + 2 (1 - F1); nll = the mean negative log-likelihood of a
    #: beam (default packet_f1).
    objective: str
    tune: Sequence[str]  #: Options of fit to tune instead of the usual ones.
    budget: int  #: Largest number of evaluations (default 60).
    slice: Sequence[float]  #: Use the scans that begin in [FROM, TO), s after the log's start (default 0,10).
    #: Score every N-th scan and fit the others; where there are fewer than N scans, groups of beams take the place
    #: of scans (default 4).
    validate: int
    algorithm: str  #: Search algorithm of NLopt (default cobyla).
    step: float  #: First step, as a share of each parameter's range (default 0.2).


class ImportParameters(TypedDict, total=False):
    """Options of `import`, as docs/reference/command-line.md lists them."""

    format: str  #: Format of the source (default: detected).
    poses: str | os.PathLike[str]  #: File of the sensor's poses, in TUM or KITTI format.
    times: str | os.PathLike[str]  #: File of the scans' times, one on each line, s.
    labels: str | os.PathLike[str]  #: Labels of a single scan, a SemanticKITTI .label file.
    label_set: str  #: Label set of the column class (default: semantickitti for .label files).
    keep: str  #: Read only the points with this value of a column, such as first returns: target_index=1.
    columns: str  #: Names of the columns, for .bin and text files without a header: x,y,z,intensity,ring.
    unit: str  #: Unit of the coordinates (default m).
    assets: str | os.PathLike[str]  #: Folder with the files of a survey of HELIOS++, besides the folder of the survey.
    frames: str  #: Scans to read, by number, half-open: A:B or A:B:STEP.
    deskew: str  #: Compute a pose for every beam from the timing of this sensor, for raw scans.
    #: How times of points count: after the scan's time; before it, back from its last point; or until it, the time
    #: of the last point (default after).
    point_times: str
    #: With --deskew: use the times of scans unchanged instead of fitting a clock to rounded ones (default false).
    times_as_given: bool
    #: Leave out misses below this elevation, where beams may end at the own vehicle; by default, inferred misses
    #: below -13 are left out, and all recorded misses are kept.
    unknown_below_deg: float
    #: Turn every beam up by this angle, for a known fault of the recording (KITTI: 0.205) (default 0).
    elevation_offset_deg: float
    infer_misses: str  #: Infer misses from this sensor's scan pattern, for formats that drop them.
    #: Range of a miss; 0 = the maximum range of the sensor or of the log. Points of scans at this range are misses
    #: (m; default 0).
    max_range: float
    #: The points are in the world frame already, and the poses only give the place of the sensor (default false).
    points_in_world: bool


class SplitParameters(TypedDict, total=False):
    """Options of `split`, as docs/reference/command-line.md lists them."""

    every: int  #: Hold out one scan of every N.
    #: Hold out one column of every N in each scan; a column has the beams that were fired at one time, or those of
    #: one packet if the log has no times of beams.
    columns: int
    time: Sequence[float]  #: Hold out the scans whose time lies in [FROM, TO), s after the log's start.
    region: Sequence[float]  #: Hold out the scans whose sensor stands in this rectangle of the world, m.
    #: With --every and --columns: number of the scan or column that is held out in each group of N, counted from 0
    #: (default 1).
    offset: int


class SegmentParameters(TypedDict, total=False):
    """Options of `segment`, as docs/reference/command-line.md lists them."""

    #: Take labels from this file: a SemanticKITTI .label file, or a PLY, PCD or CSV file with a column class or
    #: instance (also the log itself).
    labels: str | os.PathLike[str]
    label_set: str  #: Label set that gives the numbers of --labels their meaning.
    truth: str  #: Column of the log with the numbers of the true trees, for comparison (default instance).
    ground_method: str  #: Method of ground segmentation (default lower_envelope).
    min_range: float  #: Give no label to returns nearer than this; they may be on the own vehicle (m; default 0).
    tile: float  #: Side of a tile of the ground segmentation (m; default 32).
    cell: float  #: Side of a column; 0 = 0.4, or more where points are sparse (m; default 0).
    gap: float  #: Empty height that separates objects in a column; 0 = by the side of the column (m; default 0).
    min_points: int  #: Least number of points of an object (default 10).
    #: Distance below which two tree tops are one crown; 6 % of the tree's height is added (m; default 1.2).
    spacing: float
    #: Join two crowns if the dip of the canopy between their tops is less deep than this; 4 % of the tree's height
    #: is added (m; default 0.3).
    prominence: float
    #: Largest distance of the edge of a crown from its top; 30 % of the tree's height is added (m; default 1.5).
    radius: float
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
    #: A return counts as moving if its place is empty in the N first or the N last of the compared scans that
    #: measured the place (default 3).
    least_empty: int
    cell_deg: float  #: Width of the cells in which scans are compared (degrees; default 0.5).
    max_range: float  #: Largest range of the returns that may be marked (m; default 80).
    same_m: float  #: Largest difference of two ranges of one surface; 1 % of the range is added (m; default 0.3).
    least_points: int  #: Least number of returns of a moving object in a scan (default 12).


class ActorsParameters(TypedDict, total=False):
    """Options of `actors`, as docs/reference/command-line.md lists them."""

    boxes_elevation_deg: float  #: Turn labelled boxes up by this angle, if import turned the beams by it (default 0).
    margin: float  #: Distance outside a box up to which returns belong to the object of the box (m; default 0.3).
    foot: float  #: Height above the bottom of a box up to which returns are those of the ground (m; default 0.15).
    least_returns: int  #: Leave out objects with fewer returns in all scans (default 30).
    #: Time for which a pedestrian is treated as rigid; each such part of a walk has its own model (s; default 0.5).
    walk: float
    poses_as_given: bool  #: Keep the poses of the boxes instead of registering the scans of an object (default false).
    #: Leave the unseen side of vehicles and cyclists empty instead of mirroring the other side (default false).
    one_sided: bool


class ExtractParameters(TypedDict, total=False):
    """Options of `extract`, as docs/reference/command-line.md lists them."""

    #: Fit each box to the points between the quantiles X and 1 − X along each axis; 0 = all points (the code of the
    #: authors of [tallavajhula18] has 0.05) (default 0).
    box_quantile: float
    #: Which elements belong to an object: box = all whose centres lie in its box; own = elements in the box that
    #: also lie among the object's points (default own).
    elements: str
    #: Leave out ellipsoids that stopped less than this share of the beams that met them (default 0).
    free_space_below: float
    patch_cell: float  #: Side of the cells that patches of shrubs are cut into (m; default 2).
    min_elements: int  #: Leave out objects and cells with fewer elements (default 1).
    min_points: int  #: Leave out objects and cells with fewer points (default 5).


class ComposeParameters(TypedDict, total=False):
    """Options of `compose`, as docs/reference/command-line.md lists them."""

    #: How the primitive of an object is chosen in its class: box = the nearest box; best = the best fit to the
    #: object's points and beams; it is adapted to them, and no plant is repeated within 20 m if others fit; random
    #: = a random one (default best).
    choose: str
    nearest: int  #: Choose each primitive at random among the N best ones (default 1).
    scale: bool  #: Scale each primitive to the box of its object (default false).
    #: Use no primitive that was cut from an object whose box overlaps one of this annotation, as seen from above.
    leave_out: Sequence[str]
    allow_outside: bool  #: Follow paths of the annotation that lead out of its folder (default false).
    strict: bool  #: Fail if an object cannot be placed as annotated (default false).


class PerceiveParameters(TypedDict, total=False):
    """Options of `perceive`, as docs/reference/command-line.md lists them."""

    #: The true objects: labelled boxes in the sensor's frame (CSV with frame and track_id), or lists of objects in
    #: the world's frame (CSV, JSON, or an OSI trace).
    truth: str | os.PathLike[str]
    #: How objects are found: model = the tracking model, which assigns points to true objects; real = without the
    #: truth (default model).
    pipeline: str
    rig: str | os.PathLike[str]  #: File with the sensors of the vehicle, for a log of several sensors.
    min_range: float  #: Ignore hits nearer than this; for example those on the own vehicle (m; default 0).
    #: Height of the sensor above the ground, on which the vehicle's frame stands; the file of a rig has the heights
    #: of its sensors (m; default 0).
    sensor_height: float
    truth_elevation_deg: float  #: Turn labelled boxes up by this angle, if import turned the beams by it (default 0).
    no_deskew: bool  #: Ignore the vehicle's motion within a cycle (default false).
    #: When an object is listed: probability = when its probability of existence is high enough; in-a-row = after
    #: --needed cycles with points in a row; out-of = after points in --needed of --window cycles (default
    #: probability).
    existence: str
    gain: float  #: Increase of an object's existence probability in a cycle in which it has points (default 0.2).
    loss: float  #: Decrease of an object's existence probability in a cycle in which it has no points (default 0.055).
    threshold: float  #: Least existence probability of a listed object (default 0.5).
    start_points: int  #: An object that is not listed needs more points than this number (default 3).
    #: Full size of a segment; smaller segments raise the existence probability less; 0 = all segments raise it
    #: equally (m; default 0).
    full_extent: float
    needed: int  #: Number of cycles with points after which an object is listed (default 5).
    window: int  #: Number of recent cycles among which those with points are counted (default 10).
    #: Number of cycles in a row without points after which an object is dropped, with --existence in-a-row or out-
    #: of (default 10).
    lost: int
    reference: str  #: The point that is tracked (default corner).
    heading: str  #: The source of the tracking model's headings (default points).
    #: Report the boxes of the visible points instead of completing them to the sizes of the class (default false).
    as_measured: bool
    ground: str  #: Ground removal of the real pipeline (default cone).
    latency_ms: float  #: Time from a cloud to its list (ms; default 0).
    #: Merge objects of the tracking model that are nearer to each other than the sensor resolves (default false).
    merge_close: bool
    merge_gap: float  #: Distance below which objects are always merged (m; default 0.3).
    ghosts_per_s: float  #: Mean number of ghost objects that appear per second (default 0).
    ghost_life: float  #: Mean life of a ghost object (s; default 0.5).
    cell: float  #: Side of a cell (m; default 0.2).
    half_side: float  #: Distance that the grid reaches from the vehicle along x and y (m; default 40).
    low: float  #: Lower bound of the heights above the ground that count as obstacles (m; default 0.2).
    high: float  #: Upper bound of the heights above the ground that count as obstacles (m; default 2).
    memory: float  #: Share of the evidence that is kept from cycle to cycle (default 0.9).
    label_probability: float  #: A cell is unknown if no state has at least this probability (default 0.6).
