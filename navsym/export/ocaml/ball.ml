(* Intervals with ends m 2^e, rounded outward, and the functions of the format on them. Section 4 of docs/certificates.md.

   Every function here gives an interval that contains all results for all numbers of its operands. Series are summed in intervals, so
   rounding is inside; what is cut off is bounded by twice the first term left out, and the comment of each series says why. *)

open Text

exception No_value (* a result may not exist *)

type finish = Minus | At of Z.t * int | Plus
type ball = { lo : finish; hi : finish }

let precision = ref 64
let cap = 2_000_000 (* ends beyond 2^cap are infinite, ends below 2^-cap are 0 or 2^-cap, always outward *)

(* Ends *)

let nought = At (Z.zero, 0)
let place m e = Z.numbits m + e (* 2^(place - 1) <= |m 2^e| < 2^place *)
let shift_up m s = Z.neg (Z.shift_right (Z.neg m) s)

let round up m e =
  let excess = Z.numbits m - !precision in
  let m, e = if excess > 0 then ((if up then shift_up m excess else Z.shift_right m excess), e + excess) else (m, e) in
  let sign = Z.sign m in
  if sign = 0 then nought
  else if place m e > cap then
    match (sign > 0, up) with
    | true, true -> Plus
    | true, false -> At (Z.one, cap - 1)
    | false, true -> At (Z.minus_one, cap - 1)
    | false, false -> Minus
  else if place m e < -cap then if sign > 0 = up then At (Z.of_int sign, -cap) else nought
  else At (m, e)

let sign_of = function Minus -> -1 | Plus -> 1 | At (m, _) -> Z.sign m

let align (m, e) (n, f) = if e <= f then (m, Z.shift_left n (f - e), e) else (Z.shift_left m (e - f), n, f)

let compare_ends a b =
  match (a, b) with
  | Minus, Minus | Plus, Plus -> 0
  | Minus, _ | _, Plus -> -1
  | Plus, _ | _, Minus -> 1
  | At (m, e), At (n, f) ->
      let s = Z.sign m and t = Z.sign n in
      if s <> t then compare s t
      else if s = 0 then 0
      else if place m e <> place n f then s * compare (place m e) (place n f)
      else let m, n, _ = align (m, e) (n, f) in Z.compare m n

let least a b = if compare_ends a b <= 0 then a else b
let greatest a b = if compare_ends a b >= 0 then a else b
let opposite = function Minus -> Plus | Plus -> Minus | At (m, e) -> At (Z.neg m, e)

let add_ends up a b =
  match (a, b) with
  | At (m, e), At (n, f) ->
      if Z.sign m = 0 then round up n f else if Z.sign n = 0 then round up m e
      else let m, n, e = align (m, e) (n, f) in round up (Z.add m n) e
  | At _, infinite | infinite, At _ -> infinite
  | _ -> if up then Plus else Minus

(* 0 times an infinite end is 0: ends stand for numbers that are large, never for an infinite factor. *)
let multiply_ends up a b =
  match (a, b) with
  | At (m, e), At (n, f) -> round up (Z.mul m n) (e + f)
  | _ -> ( match sign_of a * sign_of b with 0 -> nought | s when s > 0 -> Plus | _ -> Minus)

(* b is not 0. An infinite end by an infinite end is 0: the other quotients of the same balls reach further. *)
let divide_ends up a b =
  match (a, b) with
  | At (m, e), At (n, f) ->
      let k = max 0 (!precision + 2 + Z.numbits n - Z.numbits m) in
      let top = Z.shift_left m k in
      round up (if up then Z.cdiv top n else Z.fdiv top n) (e - f - k)
  | _, (Minus | Plus) -> nought
  | _, At (n, _) -> if sign_of a * Z.sign n > 0 then Plus else Minus

(* Balls *)

let exactly m e = { lo = At (m, e); hi = At (m, e) }
let of_int n = exactly (Z.of_int n) 0
let everything = { lo = Minus; hi = Plus }
let ball_zero = of_int 0
let ball_one = of_int 1
let between a b = { lo = a; hi = b }
let is_finite x = match (x.lo, x.hi) with At _, At _ -> true | _ -> false
let is_above x = sign_of x.lo > 0
let is_below x = sign_of x.hi < 0
let has_zero x = sign_of x.lo <= 0 && sign_of x.hi >= 0
let is_exactly_zero x = sign_of x.lo = 0 && sign_of x.hi = 0
let hull x y = { lo = least x.lo y.lo; hi = greatest x.hi y.hi }
let minus x = { lo = opposite x.hi; hi = opposite x.lo }
let plus x y = { lo = add_ends false x.lo y.lo; hi = add_ends true x.hi y.hi }
let less x y = plus x (minus y)

let round_ball x =
  let go up = function At (m, e) -> round up m e | infinite -> infinite in
  { lo = go false x.lo; hi = go true x.hi }

let corners op x y =
  let best up pick = pick (pick (op up x.lo y.lo) (op up x.lo y.hi)) (pick (op up x.hi y.lo) (op up x.hi y.hi)) in
  { lo = best false least; hi = best true greatest }

let times x y =
  if sign_of x.lo >= 0 && sign_of y.lo >= 0 then
    { lo = multiply_ends false x.lo y.lo; hi = multiply_ends true x.hi y.hi }
  else corners multiply_ends x y

let over x y = if has_zero y then raise No_value else corners divide_ends x y
let of_rational q = over (exactly q.Q.num 0) (exactly q.Q.den 0)
let magnitude x = greatest (opposite x.lo) x.hi
let size x = if has_zero x then { lo = nought; hi = magnitude x } else if is_below x then minus x else x
let around x = let m = magnitude x in { lo = opposite m; hi = m }
let double x = plus x x

(* Half of a ball and other powers of 2 are exact. *)
let scale x k =
  let go up = function At (m, e) -> round up m (e + k) | infinite -> infinite in
  { lo = go false x.lo; hi = go true x.hi }

let with_more bits f =
  let old = !precision in
  precision := old + bits;
  Fun.protect ~finally:(fun () -> precision := old) f

let guarded bits f = round_ball (with_more bits f)

(* The ball of a function that rises, from its balls at numbers. *)
let rising at_point x ~low ~high =
  {
    lo = (match x.lo with At (m, e) -> (at_point (m, e)).lo | _ -> low);
    hi = (match x.hi with At (m, e) -> (at_point (m, e)).hi | _ -> high);
  }

let falling at_point x ~low ~high =
  {
    lo = (match x.hi with At (m, e) -> (at_point (m, e)).lo | _ -> low);
    hi = (match x.lo with At (m, e) -> (at_point (m, e)).hi | _ -> high);
  }

(* A power with a whole exponent n >= 0 *)
let rec whole_power x n =
  if n = 0 then ball_one
  else if n = 1 then x
  else
    let h = whole_power x (n / 2) in
    let s = times h h in
    if n land 1 = 1 then times s x else s

let power x n = guarded 16 (fun () -> if n land 1 = 0 then whole_power (size x) n else
  rising (fun (m, e) -> whole_power (exactly m e) n) x ~low:Minus ~high:Plus)

(* Series *)

(* True when the ball lies within 2^-bits of 0. *)
let is_within bits x = match magnitude x with At (m, e) -> Z.sign m = 0 || place m e <= -bits | _ -> false

(* The sum of terms, the next from the last one and its number. At the end twice the first term left out is added on both sides.
   That is right where the rest is at most twice that term: alternating terms that fall, or a factor of at most 1/2 from term to term. *)
let sum_terms ~bits first next =
  let rec go j term sum =
    if is_within bits term then plus sum (around (double term)) else go (j + 1) (next j term) (plus sum term)
  in
  go 0 first ball_zero

let top_bit x = match magnitude x with At (m, e) -> place m e | _ -> raise No_value

(* exp(r) for |r| <= 1/2: every term is at most half of the one before. *)
let exp_series r = sum_terms ~bits:(!precision) ball_one (fun j term -> over (times term r) (of_int (j + 1)))

let exp_point (m, e) =
  let top = place m e in
  if Z.sign m = 0 then ball_one
  else if top > 22 then
    if Z.sign m > 0 then { lo = At (Z.one, cap - 1); hi = Plus } else { lo = nought; hi = At (Z.one, -cap) }
  else
    let k = max 0 (top + 8) in
    guarded (k + 16) (fun () ->
        let rec square k x = if k = 0 then x else square (k - 1) (times x x) in
        square k (exp_series (exactly m (e - k))))

let exp_ball x = rising exp_point x ~low:nought ~high:Plus

(* Sum of sign^j t^(2j+1)/(2j+1) for |t| <= 1/2: artanh for sign 1, arctan for -1. The terms fall at least by the factor 1/4. *)
let odd_series sign t =
  if is_exactly_zero t then ball_zero
  else
    let bits = !precision - top_bit t and square = times t t in
    let rec go j power sum =
      let term = over power (of_int ((2 * j) + 1)) in
      if is_within bits term then plus sum (around (double term))
      else
        let next = times power square in
        go (j + 1) (if sign < 0 then minus next else next) (plus sum term)
    in
    go 0 t ball_zero

let cached compute =
  let known = Hashtbl.create 4 in
  fun () ->
    match Hashtbl.find_opt known !precision with
    | Some x -> x
    | None ->
        let x = compute () in
        Hashtbl.replace known !precision x;
        x

(* log 2 = 2 artanh(1/3) *)
let log_two = cached (fun () -> guarded 16 (fun () -> double (odd_series 1 (over ball_one (of_int 3)))))

(* pi = 16 arctan(1/5) - 4 arctan(1/239) *)
let pi =
  cached (fun () ->
      guarded 16 (fun () ->
          let arc n = odd_series (-1) (over ball_one (of_int n)) in
          less (scale (arc 5) 4) (scale (arc 239) 2)))

let half_pi_ball () = scale (pi ()) (-1)

(* x = y 2^s with y in [0.7, 1.42]; log y = 2 artanh((y - 1)/(y + 1)), where the quotient is at most 0.18 in size. *)
let log_point (m, e) =
  let n = Z.numbits m in
  let low = Z.lt (Z.mul m (Z.of_int 256)) (Z.shift_left (Z.of_int 181) n) in
  let y, s = if low then (exactly m (1 - n), e + n - 1) else (exactly m (-n), e + n) in
  guarded 40 (fun () ->
      let t = over (less y ball_one) (plus y ball_one) in
      plus (double (odd_series 1 t)) (times (of_int s) (log_two ())))

(* For x >= 0; the end 0 gives minus infinity. *)
let log_ball x =
  let at_point (m, e) = if Z.sign m <= 0 then everything else log_point (m, e) in
  rising at_point x ~low:Minus ~high:Plus

let sqrt_point (m, e) =
  let k = max 0 (2 * (!precision + 2) - Z.numbits m) in
  let k = if (e - k) land 1 = 0 then k else k + 1 in
  let n = Z.shift_left m k in
  let r = Z.sqrt n in
  let up = if Z.equal (Z.mul r r) n then r else Z.succ r in
  { lo = round false r ((e - k) / 2); hi = round true up ((e - k) / 2) }

let sqrt_ball x = rising sqrt_point x ~low:nought ~high:Plus

(* arctan: 1/x for |x| > 1, then three times tan(a/2) = t/(1 + sqrt(1 + t^2)), then the series for |t| <= 1/8. *)
let atan_point (m, e) =
  let x = exactly m e in
  let halve t = over t (plus ball_one (sqrt_ball (plus ball_one (times t t)))) in
  let inner t = scale (odd_series (-1) (halve (halve (halve t)))) 3 in
  if Z.sign m = 0 then ball_zero
  else
    guarded 24 (fun () ->
        if compare_ends (magnitude x) (At (Z.one, 0)) <= 0 then inner x
        else
          let h = half_pi_ball () in
          less (if Z.sign m > 0 then h else minus h) (inner (over ball_one x)))

let atan_ball x = let h = half_pi_ball () in rising atan_point x ~low:(opposite h.hi) ~high:h.hi

(* sin and cos of r with |r| <= 1: the terms alternate and fall. *)
let sin_cos_series r =
  let bits = !precision and s = minus (times r r) in
  let next first j term = over (times term s) (of_int (((2 * j) + first) * ((2 * j) + first + 1))) in
  (sum_terms ~bits r (next 2), sum_terms ~bits ball_one (next 1))

let floor_of = function
  | At (m, e) -> if e >= 0 then Z.shift_left m e else Z.shift_right m (-e)
  | _ -> raise No_value

let unit_ball = { lo = At (Z.minus_one, 0); hi = At (Z.one, 0) }

let clip x box = { lo = greatest x.lo box.lo; hi = least x.hi box.hi }

(* sin(x + turn pi/2) of a number: x = k pi/2 + r. *)
let sin_point turn (m, e) =
  let top = max 0 (place m e) in
  if top > 20000 then unit_ball
  else
    clip (guarded (top + 24) (fun () ->
        let x = exactly m e in
        let quarter = over x (half_pi_ball ()) in
        let k = floor_of (plus quarter (scale ball_one (-1))).lo in
        let r = less x (times (exactly k 0) (half_pi_ball ())) in
        if compare_ends (magnitude r) (At (Z.one, 0)) > 0 then unit_ball
        else
          let s, c = sin_cos_series r in
          match Z.to_int (Z.erem (Z.add k (Z.of_int turn)) (Z.of_int 4)) with
          | 0 -> s
          | 1 -> c
          | 2 -> minus s
          | _ -> minus c)) unit_ball

(* sin(x + turn pi/2) of a ball: between its ends, and 1 or -1 where an extremum may lie inside: x + turn pi/2 = n pi/2, n = 1 or 3 mod 4. *)
let sin_ball turn x =
  match (x.lo, x.hi) with
  | At (m, e), At (n, f) when place m e < 20000 && place n f < 20000 ->
      let ends = hull (sin_point turn (m, e)) (sin_point turn (n, f)) in
      if compare_ends x.lo x.hi = 0 then ends
      else
        let quarters = with_more (24 + max 0 (max (place m e) (place n f))) (fun () -> over x (half_pi_ball ())) in
        let first = Z.neg (floor_of (opposite quarters.lo)) and last = floor_of quarters.hi in
        (* an n = [rest] mod 4 with first <= n <= last *)
        let meets rest =
          let d = Z.erem (Z.sub (Z.of_int (rest - turn)) first) (Z.of_int 4) in
          Z.leq (Z.add first d) last
        in
        {
          lo = (if meets 3 then At (Z.minus_one, 0) else ends.lo);
          hi = (if meets 1 then At (Z.one, 0) else ends.hi);
        }
  | _ -> unit_ball

let sinh_point p = guarded 16 (fun () -> scale (less (exp_point p) (exp_point (Z.neg (fst p), snd p))) (-1))
let cosh_point p = guarded 16 (fun () -> scale (plus (exp_point p) (exp_point (Z.neg (fst p), snd p))) (-1))

(* tanh x = 1 - 2/(exp(2x) + 1) *)
let tanh_point (m, e) =
  guarded 16 (fun () -> less ball_one (over (of_int 2) (plus (exp_point (m, e + 1)) ball_one)))

let sinh_ball x = rising sinh_point x ~low:Minus ~high:Plus
let cosh_ball x = rising cosh_point (size x) ~low:ball_one.lo ~high:Plus
let tanh_ball x = clip (rising tanh_point x ~low:unit_ball.lo ~high:unit_ball.hi) unit_ball

(* arcsin x = arctan(x/sqrt(1 - x^2)) for |x| < 1 *)

(* erf(x) = 2 exp(-x^2)/sqrt(pi) times the sum of the terms t_0 = x, t_n = t_(n - 1) 2 x^2/(2n + 1). They are small only where n > 2 x^2,
   and then every term is at most half of the one before. For large x it lies between 1 - exp(-x^2) and 1. *)
let erf_point (m, e) =
  let x = exactly (Z.abs m) e in
  let value =
    if Z.sign m = 0 then ball_zero
    else if place m e > 6 then { lo = (less ball_one (exp_ball (minus (power x 2)))).lo; hi = ball_one.hi }
    else
      guarded 64 (fun () ->
          let square = double (power x 2) in
          let next j term = over (times term square) (of_int ((2 * j) + 3)) in
          let factor = over (double (exp_ball (minus (power x 2)))) (sqrt_ball (pi ())) in
          times factor (sum_terms ~bits:!precision x next))
  in
  if Z.sign m < 0 then minus value else value

let erf_ball x = clip (rising erf_point x ~low:unit_ball.lo ~high:unit_ball.hi) unit_ball

let asin_point (m, e) =
  let x = exactly m e in
  guarded 16 (fun () ->
      let h = half_pi_ball () in
      if compare_ends x.hi unit_ball.lo <= 0 then minus h
      else if compare_ends x.lo unit_ball.hi >= 0 then h
      else
        let below = sqrt_ball (times (plus ball_one x) (less ball_one x)) in
        if is_above below then atan_ball (over x below) else if Z.sign m > 0 then { lo = nought; hi = h.hi } else { lo = opposite h.hi; hi = nought })

let asin_ball x = rising asin_point x ~low:unit_ball.lo ~high:unit_ball.hi
let acos_ball x = falling (fun p -> guarded 8 (fun () -> less (half_pi_ball ()) (asin_point p))) x ~low:nought ~high:nought

(* The angle of the point (x, y); no value where the ball may meet the cut y = 0, x <= 0. *)
let atan2_ball y x =
  guarded 8 (fun () ->
      if is_above x then atan_ball (over y x)
      else if is_above y then less (half_pi_ball ()) (atan_ball (over x y))
      else if is_below y then less (minus (half_pi_ball ())) (atan_ball (over x y))
      else if is_exactly_zero y && is_below x then pi ()
      else raise No_value)

(* exp_k, sin_k, cos_k for |x| <= 1: the sum of s_(j + k) x^j, with s the Taylor coefficients. From term to term the size falls at least
   by the factor 1/(j + k + 1), so from j = 1 on by 1/2; the terms of sin and cos are a part of those of exp. *)
let tail_ball name k x =
  if not (is_finite x) || compare_ends (magnitude x) (At (Z.one, 0)) > 0 then refuse "%s_%d outside of [-1, 1]" name k;
  guarded 16 (fun () ->
      let rec factorial n = if n <= 1 then Z.one else Z.mul (Z.of_int n) (factorial (n - 1)) in
      let coefficient n =
        match (name, n land 3) with
        | "exp", _ -> 1
        | "sin", 1 | "cos", 0 -> 1
        | "sin", 3 | "cos", 2 -> -1
        | _ -> 0
      in
      let rec go j unsigned sum =
        if j > 0 && is_within !precision unsigned then plus sum (around (double unsigned))
        else
          let term = match coefficient (j + k) with 1 -> unsigned | -1 -> minus unsigned | _ -> ball_zero in
          go (j + 1) (over (times unsigned x) (of_int (j + k + 1))) (plus sum term)
      in
      go 0 (over ball_one (exactly (factorial k) 0)) ball_zero)
