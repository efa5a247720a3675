# Where the objectives have their minima, from the tables of objective_bias.
# gnuplot -e "folder='…'; figure='…'" objective_bias.gp
set terminal svg size 1080,420 font "sans-serif,11" background "#ffffff"
set output figure
set datafile separator ","
set grid linecolor rgb "#dddddd"
rows(file, o) = sprintf("< grep '^%s,' '%s/%s.csv'", o, folder, file)
# Colours that stay apart for colour-blind readers (Okabe and Ito).
set linetype 1 linecolor rgb "#0072B2" linewidth 1.5 pointtype 7
set linetype 2 linecolor rgb "#009E73" linewidth 1.5 pointtype 7
set linetype 3 linecolor rgb "#E69F00" linewidth 1.5
set linetype 4 linecolor rgb "#D55E00" linewidth 1.5 pointtype 7
set linetype 5 linecolor rgb "#CC79A7" linewidth 1.5 dashtype 3
set linetype 6 linecolor rgb "#444444" linewidth 1 dashtype 2 pointtype 6
set multiplot layout 1,3 title "a stiff string, 1 % noise, all else true"
set bmargin 8
set key at screen 0.38, screen 0.02 center bottom vertical maxrows 2 samplen 2 noenhanced
set ylabel "objective, from its lowest to its highest value"
set arrow 1 from 0, graph 0 to 0, graph 1 nohead dashtype 2 linecolor rgb "#444444"
set xlabel "x_c off the truth [mm]"
plot rows("contact", "joint_likelihood") using 2:3 with lines linetype 1 title "joint_likelihood", \
  rows("contact", "force_mismatch") using 2:3 with lines linetype 2 title "force_mismatch", \
  rows("contact", "contact_location") using 2:3 with lines linetype 3 title "contact_location", \
  rows("contact", "spectral_peak") using 2:3 with lines linetype 4 title "spectral_peak", \
  rows("contact", "smooth_spectral_peak") using 2:3 with lines linetype 5 title "smooth_spectral_peak"
unset key
set xlabel "f_9 off the truth [%]"
plot rows("frequency", "joint_likelihood") using 2:3 with lines linetype 1, \
  rows("frequency", "force_mismatch") using 2:3 with lines linetype 2, \
  rows("frequency", "spectral_peak") using 2:3 with lines linetype 4, \
  rows("frequency", "smooth_spectral_peak") using 2:3 with lines linetype 5
unset arrow 1
set xlabel "mode n"
set ylabel "minimum off the true f_n [%]"
set key at screen 0.86, screen 0.03 center bottom horizontal maxrows 1 samplen 2
plot rows("offsets", "line") using 2:(100*$3) with linespoints linetype 6 title "nearest line of the force", \
  rows("offsets", "spectral_peak") using 2:(100*$3) with points linetype 4 notitle, \
  rows("offsets", "force_mismatch") using 2:(100*$3) with points linetype 2 pointsize 0.7 notitle, \
  rows("offsets", "joint_likelihood") using 2:(100*$3) with points linetype 1 pointsize 0.5 notitle
unset multiplot
