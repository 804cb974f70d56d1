# Draws bench/out/scenes.csv: how many times our time others need for a step of each scene; longer is slower.
set terminal pngcairo noenhanced size 1200,620 font "sans,10"
set output picture
set datafile separator ","
set logscale y 2
set yrange [0.25:*]
set border 3 lc rgb "#888888"
set tics nomirror
set grid ytics lc rgb "#dddddd"
set xtics rotate by -30 ()
set arrow from graph 0, first 1 to graph 1, first 1 nohead lc rgb "#888888"
set ylabel "CPU time of a step, ours = 1"
set key below samplen 2 width 2
set title "Whole steps: the same scenes, one thread, sleeping off" font "sans,13"
set offsets 0.5, 0.5, 0, 0
colours = "#0044aa #33bbee #009988 #cc3311 #ee7733 #aa3377 #664422 #eeaa33"
engines = system("awk -F, 'NR > 1 && !s[$5]++ {print $5}' " . csv)
scenes = system("awk -F, 'NR > 1 && !s[$1]++ {print $1}' " . csv)
set for [i = 1:words(scenes)] xtics add (word(scenes, i) i)
place(name) = (k = 0, sum [i = 1:words(scenes)] (word(scenes, i) eq name ? i : 0))
plot for [e = 1:words(engines)] csv skip 1 \
     using (place(strcol(1)) + 0.06 * (e - words(engines) / 2.0)):(strcol(5) eq word(engines, e) ? column(9) : NaN) \
     with points pt 7 ps 1.3 lc rgb word(colours, 1 + (e - 1) % words(colours)) title word(engines, e)
