# Error of the calibrated frequencies against processor time, from calibration_work_precision.
# gnuplot -e "table='…'; figure='…'" calibration_work_precision.gp
set terminal svg size 1350,640 font "sans-serif,11" background "#ffffff"
set output figure
set datafile separator ","
set logscale xy
set format xy "10^{%T}"
set grid linecolor rgb "#dddddd"
array color[5] = ["#0072B2", "#009E73", "#E69F00", "#56B4E9", "#444444"]
array family[5] = ["residuals", "gradient", "values", "global", "systematic"]
array objective[9] = ["spectral_peak", "smooth_spectral_peak", "force_mismatch", "contact_location", \
                      "contact_location_squares", "joint_likelihood damped", "joint_likelihood", \
                      "joint_likelihood + frequency_prior", "innovation_misfit"]
# A search a line: an empty record before each.
rows(o, f) = sprintf("< awk -F, '$1==\"%s\" && $3==\"%s\" {if ($2!=last) print \"\"; last=$2; print}' '%s'", \
                     o, f, table)
bound = real(system(sprintf("awk '/^# bound/ {print $3; exit}' '%s'", table)))
set yrange [5e-7:3e-3]
set xlabel "processor time [ms]"
set multiplot layout 2,5 title "law and contact of a stiff string, 16 modes, 0.5 s, 1 % noise"
unset key
do for [o=1:9] {
  if (o == 9) { set xrange [100:100000] } else { set xrange [0.1:300] }
  set title objective[o] noenhanced
  if (o == 1 || o == 6) { set ylabel "median relative error of f_n" } else { unset ylabel }
  plot for [f=5:1:-1] rows(objective[o], family[f]) using 4:6 with steps linecolor rgb color[f] linewidth 1, \
    bound with lines dashtype 2 linewidth 1.5 linecolor rgb "#D55E00"
}
unset xlabel; unset ylabel; unset tics; unset grid; unset border
set title "optimizers"
set key center center vertical samplen 2 font ",11"
set xrange [1:2]; set yrange [1:2]
plot for [f=1:5] NaN with lines linewidth 2 linecolor rgb color[f] title \
  (f==1 ? "least squares on residuals" : f==2 ? "local, by slopes" : f==3 ? "local, values only" : \
   f==4 ? "global, values only" : "systematic"), \
  NaN with lines dashtype 2 linewidth 1.5 linecolor rgb "#D55E00" title "Cramér–Rao bound"
unset multiplot
