# Error of the contact velocity against run time, from a table of work_precision.
# gnuplot -e "table='…'; figure='…'; name='…'" work_precision.gp
set terminal svg size 980,460 font "sans-serif,12" background "#ffffff"
set output figure
set datafile separator ","
set logscale xy
set format xy "10^{%T}"
set xlabel "processor time, ms per simulated second"
set ylabel "relative L_2 error of v"
set grid linecolor rgb "#dddddd"
set key at screen 0.5, screen 0.01 center bottom horizontal maxrows 2 samplen 2
set bmargin 8
# Colours that stay apart for colour-blind readers (Okabe and Ito).
array color[6] = ["#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#444444"]
array scheme[6] = ["modal_event 2 nodes", "modal_event 3 nodes", "modal_event 4 nodes", \
                   "modal_event 5 nodes", "modal_exact", "newmark_explicit"]
rows(i) = sprintf("< grep '^%s,' '%s'", scheme[i], table)
set multiplot layout 1,2 title name.": time steps 2e-5 to 1e-7 s" noenhanced
set yrange [1e-11:10]
set title "first 50 ms"
plot for [i=1:6] rows(i) using 14:4 with linespoints linecolor rgb color[i] pointtype i \
  linewidth 1.5 title scheme[i] noenhanced
unset key
set title "1 s"
plot for [i=1:6] rows(i) using 14:9 with linespoints linecolor rgb color[i] pointtype i \
  linewidth 1.5 title scheme[i] noenhanced
unset multiplot
