# Draws the stability map: gnuplot -e "folder='DIR'; out='FILE.svg'" stability_map.gp
load folder.'/axes.gp'
cells = folder.'/cells.txt'
set terminal svg size 1800,720 font 'sans-serif,11' background 'white'
set output out
set multiplot layout 3,8 margins 0.045,0.995,0.10,0.93 spacing 0.045,0.06
unset key
unset colorbox
# Safe for colour-blind readers: right blue, refused grey, reported yellow, wrong red.
set palette defined (0 '#3b78b4', 1 '#c8c8c8', 2 '#f0c040', 3 '#d03030')
set cbrange [0:3]
set xrange [-0.6:6.6]
set yrange [-0.6:7.6]
set xtics ('10 ns' 0, '' 1, '1 us' 2, '' 3, '100 us' 4, '' 5, '10 ms' 6)
set tics scale 0.4 font ',9'
do for [simulator in 'newmark_explicit modal_exact modal_event'] {
  do for [panel = 0:7] {
    eval 'set ytics ('.value('tics_'.panel).')'
    set title (simulator eq 'newmark_explicit' ? value('title_'.panel) : '') offset 0,-0.5
    set ylabel (panel == 0 ? simulator : '') noenhanced offset 0.5,0
    set xlabel (simulator eq 'modal_event' ? 'time step' : '') offset 0,0.5
    plot cells using (column(1) == panel && stringcolumn(2) eq simulator ? column(3) : NaN):4:5 \
         with points pointtype 5 pointsize 1.9 linecolor palette
  }
}
unset multiplot
