"""The options of verbs; python/tests/make_parameters.py writes this file."""
from __future__ import annotations

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
    ellipsoid_prior_hits: float  #: Prior hits of an ellipsoid (default 5).
    ellipsoid_prior_misses: float  #: Prior misses of an ellipsoid (default 0).
    #: Drop ellipsoids whose share of hits, hits / (hits + misses), is below this (default 0.05).
    free_space_below: float
    range_noise: float  #: The sensor's range noise (m; default 0.02).
    triangle_prior_hits: float  #: Prior hits of a triangle; likelihood has 10 (default 10000).
    triangle_prior_misses: float  #: Prior misses of a triangle (default 0).
    credit: str  #: The rule that credits elements with the hits and misses of beams (default first).
    start: str  #: The fitter to begin with, or the folder of a model (default hierarchical).
    rounds: int  #: Largest number of M-steps (default 3).
    #: Number k of parameters fitted to the n points of each ellipsoid of the start; its variances grow by (n + k) /
    #: (n - k) (default 2).
    spent_at_start: float
    #: Assumed probability that a return is lost, so that a single miss does not make the elements that the beam met
    #: permeable (default 0.02).
    dropout: float
    #: Exponent on the probabilities of the final model; above 1, draws have smaller errors, and the likelihood is
    #: worse (default 1).
    sharpness: float
    #: Keep scans as range images (keyframes), at most 16 within this distance; simulated beams near them use their
    #: pixels; 0 = none (m; default 2).
    keyframes: float


class SimulateParameters(TypedDict, total=False):
    """Options of `simulate`, as docs/reference/command-line.md lists them."""

    #: Add columns for the element at which each beam ended and for its class; for a scene also for its instance
    #: (default false).
    element_ids: bool
    #: Trace several sub-rays in each beam and compute light, waveform and echoes: a number, COLUMNSxROWS, or sensor
    #: for the number in the sensor's data file.
    super_sample: str
    returns: str  #: The echoes that are reported: strongest, first, last, or up to N (default: the sensor's).
    #: Whether leaves and stones are drawn once, so that neighbouring beams and later scans meet the same ones, or
    #: anew for each beam (default once).
    matter: str
    #: Size of the cells in which matter that is drawn once is all there or all absent; 0 = the model's (m; default
    #: 0).
    grain: float
    tau: float  #: Mahalanobis distance within which a beam meets an ellipsoid; 0 = the model's (default 0).
    wind: float  #: Correlation time of leaves that sway; 0 = they stand still (s; default 0).
    #: How the range in an ellipsoid is drawn: along the beam, or in the ellipsoid's volume; median takes the median
    #: of the beam's distribution, which has the least error (default on_ray).
    draw: str
    #: Whether a return has the expected intensity of its element, or one that is drawn with the element's spread;
    #: for models of logs with intensities (default mean).
    intensity: str
    beam: str  #: Whether the ray is traced on the beam's axis, or drawn from the sensor's cone (default thin).
    max_range: float  #: Maximum range; 0 = the log's or the sensor's (m; default 0).
    range_noise: float  #: Standard deviation of additional noise on every range (m; default 0).
    all_sub_rays: bool  #: Trace all sub-rays of every beam, also where 13 of 26 or more agree (default false).
    #: Whether sub-rays are spread over the whole beam, or only over the excess of its width over that of the fitted
    #: log's beams, whose footprint is in the model (default excess).
    footprint: str
    materials: str  #: A table of materials that replaces the built-in one.
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
