# Error against run time of regularizers and parameter choices, from a table of regularizer_error.
# gnuplot -e "table='…'; figure='…'" regularizer_error.gp
set terminal svg size 1180,800 font "sans-serif,12" background "#ffffff"
set output figure
set datafile separator ","
set logscale xy
set grid linecolor rgb "#dddddd"
# Colours that stay apart for colour-blind readers (Okabe and Ito), marks for the rules.
array color[8] = ["#0072B2", "#56B4E9", "#444444", "#D55E00", "#E69F00", "#F0E442", "#009E73", "#CC79A7"]
array filter[8] = ["water_level", "water_level_clip", "truncated_svd", "tikhonov 0", "tikhonov 1", \
                   "tikhonov 2", "wiener", "joint"]
array rule[10] = ["minimal_product", "l_curve", "l_curve_adaptive", "gcv", "robust_gcv", "discrepancy", \
                  "quasi_optimality", "ncp", "upre", "evidence"]
array mark[10] = [7, 5, 4, 9, 8, 11, 3, 2, 13, 6]
array problem[5] = ["paper", "shaw", "heat", "phillips", "deriv2"]
rows(p, f, r) = sprintf("< grep '^%s,%s,%s,' '%s'", problem[p], filter[f], rule[r], table)
set multiplot layout 2,3 title "median relative error against processor time, parameter choice included" noenhanced
set xlabel "processor time, ms"
set ylabel "relative error"
unset key
do for [p=1:5] {
  set title problem[p] noenhanced
  set yrange [(p == 1 ? 0.4 : 0.01):(p == 1 ? 100 : 10)]
  # The joint estimate of both reactions brings a rule of its own and knows the paper's case alone.
  filters = p == 1 ? 8 : 7
  plot for [f=1:filters] for [r=(f == 8 ? 10 : 1):10] rows(p, f, r) using 9:4 with points \
    pointtype mark[r] linecolor rgb color[f] pointsize (f == 8 ? 1.6 : 0.8) linewidth 1.2
}
unset title; unset xlabel; unset ylabel; unset border; unset tics; unset grid
unset logscale
set xrange [0:1]; set yrange [0:1]
set key inside left center vertical maxrows 10 samplen 1
plot for [f=1:8] NaN with points pointtype 7 linecolor rgb color[f] title filter[f] noenhanced, \
  NaN with points pointtype -1 title " ", NaN with points pointtype -1 title " ", \
  for [r=1:10] NaN with points pointtype mark[r] linecolor rgb "#444444" title rule[r] noenhanced
unset multiplot
