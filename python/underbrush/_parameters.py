"""The parameters of a fit; python/tests/make_parameters.py writes this file."""
from __future__ import annotations

from typing import TypedDict


class FitParameters(TypedDict, total=False):
    """Options of `fit`, as `underbrush fit --help-all` lists them."""

    fitter: str  #: How the model is made (default likelihood).
    min_range: float  #: Leave out nearer returns (of the own vehicle) (m; default 0).
    tile: float  #: Side of a tile; memory grows with it (m; default 32).
    ranges_as_given: bool  #: Learn no range offsets of the sensor's channels (default false).
    clusters_per_point: float  #: Number of ellipsoids per point (default 0.1).
    min_points: int  #: Fewest points of an ellipsoid (default 3).
    #: Rounds of expectation and maximisation in which ellipsoids share the points at the borders of clusters
    #: (default 2).
    mixture_rounds: int
    voxel_side: float  #: Side of a voxel (0.05 suits a standing scanner) (m; default 0.3).
    voxel_bounded: bool  #: A beam meets a Gaussian only within the Gaussian's own voxel (default false).
    top_down_stop: str  #: The rule that leaves a cluster whole (default points).
    top_down_min_points: int  #: Fewest points of a half (default 10).
    top_down_least_gain: float  #: range_likelihood: what a split must gain (nats; default 4).
    #: range_likelihood: clusters of a larger standard deviation are split in any case (m; default 0.2).
    top_down_largest_sigma: float
    bottom_up_cell: float  #: Side of the first, small clusters (m; default 0.1).
    bottom_up_density: float  #: Share of its parts' density that a merged ellipsoid must keep (default 0.6).
    bottom_up_largest: float  #: Greatest length of a merged ellipsoid (m; default 1).
    surface_cell: float  #: Cell of the marching cubes (m; default 0.1).
    surface_kernel: float  #: Radius of the kernel (m; default 0.8).
    surface_least_kernel: float  #: Radius down to which the kernel is halved where points are dense (m; default 0.2).
    #: Largest offset of the points' mean from the surface; beyond it is a hole (kernels; default 0.3).
    surface_border: float
    surface_noise: float  #: σ of the simulated range; 0 = as the residuals along the beams are (m; default 0).
    surface_carve: bool  #: Leave out triangles that most beams passed (default false).
    ground_method: str  #: Ground segmentation (default lower_envelope).
    ground_spacing: float  #: Least distance of the nodes of the ground's height map (m; default 0.5).
    ground_smoothness: float  #: Weight of bending of the ground's height map (m²; default 0.05).
    ground_error: float  #: Largest distance of the ground mesh from the height map (m; default 0.01).
    tau: float  #: Mahalanobis distance within which a beam meets an ellipsoid (default 3).
    max_residual_for_hit: float  #: A triangle explains a point nearer than this (m; default 0.75).
    #: Points' worth of the usual size mixed into each ellipsoid's covariance (points; default 1).
    covariance_prior: float
    ellipsoid_prior_hits: float  #: Prior hits of an ellipsoid (default 5).
    ellipsoid_prior_misses: float  #: Prior misses of an ellipsoid (default 0).
    #: Drop ellipsoids with hits / (hits + misses) below this: nothing stands there (default 0.05).
    free_space_below: float
    range_noise: float  #: The sensor's range noise (m; default 0.02).
    triangle_prior_hits: float  #: Prior hits of a triangle; likelihood has 10 (default 10000).
    triangle_prior_misses: float  #: Prior misses of a triangle (default 0).
    credit: str  #: The elements that a beam is evidence of (default first).
    #: credit mahalanobis: greatest distance of a beam from an ellipsoid; at most tau counts (default 2).
    credit_tau: float
    hit_estimator: str  #: The estimate of p from an ellipsoid's hits and misses (default prior).
    start: str  #: The fitter to begin with, or the folder of a model (default hierarchical).
    rounds: int  #: Most M-steps (default 3).
    rearrangements: int  #: Most times that ellipsoids are merged and split before (default 0).
    #: Ellipsoids of the start grow as if their n points had been fitted with k parameters: their variances by (n +
    #: k) / (n - k) (default 2).
    spent_at_start: float
    held_out: int  #: One group of beams in so many judges the steps and is not learnt from (default 20).
    dropout: float  #: How readily a lone miss is taken as a lost return, not as a way through (default 0.02).
    #: How much more decided than the likeliest model: above 1 for smaller errors of a draw, at the cost of
    #: likelihood (default 1).
    sharpness: float
    #: Remember scans as range images, at most 16 within this distance; simulations near them answer likewise (0:
    #: none) (m; default 2).
    keyframes: float
    #: Most that merging two ellipsoids may cost their points; 0: merge where it costs nothing (nats; default 5).
    merge_cost: float
