(* The ball of a tree, the sign of a tree on a cell, and the mean value form. Section 4 and the rule `balls` of docs/certificates.md. *)

open Text
open Tree
open Ball

exception Nowhere (* the tree has a value at no point of the cell *)

type mode =
  | Whole (* a tree has a value on the whole ball, or there is no value *)
  | Inside (* only the points count where the tree has a value *)

(* The part of x in the box. The box may be left out by a part of x in the mode Inside only. *)
let restrict mode ?(open_low = false) x box =
  let low = compare_ends x.lo box.lo and high = compare_ends x.hi box.hi in
  if (if open_low then low > 0 else low >= 0) && high <= 0 then x
  else if mode = Whole then raise No_value
  else if compare_ends x.hi box.lo < (if open_low then 1 else 0) || compare_ends x.lo box.hi > 0 then raise Nowhere
  else clip x box

let not_negative = { lo = nought; hi = Plus }
let sqrt_in mode x = sqrt_ball (restrict mode x not_negative)
let log_in mode x = log_ball (restrict mode ~open_low:true x not_negative)

(* x^q for a rational q that is not whole *)
let broken_power mode q x =
  let x = restrict mode ~open_low:(Q.sign q < 0) x not_negative in
  let n = Q.abs q in
  let at_point (m, e) =
    if Z.sign m = 0 then ball_zero
    else if Z.equal n.Q.den (Z.of_int 2) then power (sqrt_point (m, e)) (Z.to_int n.Q.num)
    else guarded 24 (fun () -> exp_ball (times (of_rational n) (log_point (m, e))))
  in
  let root = rising at_point x ~low:nought ~high:Plus in
  if Q.sign q > 0 then root
  else if sign_of root.lo = 0 then { lo = divide_ends false (At (Z.one, 0)) (if root.hi = Plus then Plus else root.hi); hi = Plus }
  else over ball_one root

let rational_power mode q x =
  if not (is_whole q) then broken_power mode q x
  else
    let n = Z.to_int q.Q.num in
    if n > 0 then power x n else if has_zero x then raise No_value else over ball_one (power x (-n))

let tan_ball x =
  if has_zero (sin_ball 1 x) then raise No_value;
  let at_point p = guarded 8 (fun () -> over (sin_point 0 p) (sin_point 1 p)) in
  rising at_point x ~low:Minus ~high:Plus

let one_argument mode name x =
  match name with
  | "exp" -> exp_ball x
  | "sin" -> sin_ball 0 x
  | "cos" -> sin_ball 1 x
  | "atan" -> atan_ball x
  | "sinh" -> sinh_ball x
  | "cosh" -> cosh_ball x
  | "tanh" -> tanh_ball x
  | "erf" -> erf_ball x
  | "log" -> log_in mode x
  | "sqrt" -> sqrt_in mode x
  | "abs" -> size x
  | "asin" -> asin_ball (restrict mode x unit_ball)
  | "acos" -> acos_ball (restrict mode x unit_ball)
  | "tan" -> tan_ball x
  | "sec" -> over ball_one (sin_ball 1 x)
  | "cot" -> over (sin_ball 1 x) (sin_ball 0 x)
  | "csc" -> over ball_one (sin_ball 0 x)
  | _ -> ( match tail_order name with Some (f, k) -> tail_ball f k x | None -> outside "function %s" name)

(* The ball of a tree where the symbols lie in the balls that [value] gives. *)
let rec ball mode value t =
  let go = ball mode value in
  match t with
  | Num q -> of_rational q
  | Pi -> pi ()
  | Sym s -> value s
  | Sum l -> List.fold_left (fun x a -> plus x (go a)) ball_zero l
  | Prod l -> product (List.map go l)
  | Pow (a, b) -> (
      match !constant b with
      | Some q -> rational_power mode q (go a)
      | None ->
          let x = go a in
          let y = go b in
          exp_ball (times y (log_in mode x)))
  | Fun ("atan2", [ y; x ]) -> let y = go y in atan2_ball y (go x)
  | Fun (name, [ x ]) -> one_argument mode name (go x)
  | Fun (name, _) -> outside "function %s" name

and product = function [] -> ball_one | [ x ] -> x | x :: l -> List.fold_left times x l

let no_symbols s = refuse "unknown symbol %s" s

(* The finite ball of a tree without symbols, or nothing. *)
let finite_ball value t =
  match ball Whole value t with x when is_finite x -> Some x | _ -> None | exception No_value -> None

let number_ball what t =
  if has_symbols t then refuse "%s: expected no symbols" what;
  match finite_ball no_symbols t with Some x -> x | None -> refuse "%s: it may not exist" what

let satisfies relation x =
  match relation with
  | Equal -> is_exactly_zero x
  | Unequal -> not (has_zero x)
  | AtLeast -> sign_of x.lo >= 0
  | Above -> is_above x

(* Mean value form: f(c) + f'(cell) (x - c), with the derivative along x - c carried from part to part. *)

type slope = { v : ball; d : ball }

let slope_of_power q x =
  let less_one = Q.sub q Q.one in
  let rate = if Q.equal q Q.one then ball_one else rational_power Whole less_one x.v in
  { v = rational_power Whole q x.v; d = times (times (of_rational q) rate) x.d }

let slope_of_function name x =
  let v = one_argument Whole name x.v in
  let s () = sin_ball 0 x.v and c () = sin_ball 1 x.v in
  let square a = power a 2 in
  let arc sign = over (of_int sign) (sqrt_in Whole (less ball_one (square x.v))) in
  let rate =
    match name with
    | "exp" -> v
    | "sin" -> c ()
    | "cos" -> minus (s ())
    | "atan" -> over ball_one (plus ball_one (square x.v))
    | "sinh" -> cosh_ball x.v
    | "cosh" -> sinh_ball x.v
    | "tanh" -> less ball_one (square v)
    | "log" -> over ball_one x.v
    | "erf" -> over (scale (exp_ball (minus (square x.v))) 1) (sqrt_ball (pi ()))
    | "sqrt" -> over (scale ball_one (-1)) v
    | "abs" -> if is_above x.v then ball_one else if is_below x.v then minus ball_one else unit_ball
    | "asin" -> arc 1
    | "acos" -> arc (-1)
    | "tan" -> over ball_one (square (c ()))
    | "sec" -> over (s ()) (square (c ()))
    | "cot" -> minus (over ball_one (square (s ())))
    | "csc" -> minus (over (c ()) (square (s ())))
    | _ -> raise No_value
  in
  { v; d = times rate x.d }

let slope_times x y = { v = times x.v y.v; d = plus (times x.d y.v) (times x.v y.d) }

let rec slope value t =
  let go = slope value in
  let fixed v = { v; d = ball_zero } in
  match t with
  | Num q -> fixed (of_rational q)
  | Pi -> fixed (pi ())
  | Sym s -> value s
  | Sum l ->
      let add x y = { v = plus x.v y.v; d = plus x.d y.d } in
      List.fold_left (fun x a -> add x (go a)) (fixed ball_zero) l
  | Prod l -> List.fold_left (fun x a -> slope_times x (go a)) (fixed ball_one) l
  | Pow (a, b) -> (
      match !constant b with
      | Some q when Q.sign q = 0 -> fixed (rational_power Whole q (go a).v)
      | Some q -> slope_of_power q (go a)
      | None -> slope_of_function "exp" (slope_times (go b) (slope_of_function "log" (go a))))
  | Fun ("atan2", [ y; x ]) ->
      let y = go y and x = go x in
      let below = plus (power x.v 2) (power y.v 2) in
      { v = atan2_ball y.v x.v; d = over (less (times x.v y.d) (times y.v x.d)) below }
  | Fun (name, [ x ]) -> slope_of_function name (go x)
  | Fun (name, _) -> outside "function %s" name

(* The cells of a box *)

module Map_of_names = Map.Make (String)

(* A side runs from low on over a length; its part is [start, start + 1] 2^-level of it. *)
type side = { low : ball; length : ball; start : Z.t; level : int }

let part_ball s =
  let ends = between (At (s.start, -s.level)) (At (Z.succ s.start, -s.level)) in
  plus s.low (times s.length ends)

let middle_ball s = plus s.low (times s.length (exactly (Z.succ (Z.shift_left s.start 1)) (-s.level - 1)))

let find cell name = match Map_of_names.find_opt name cell with Some s -> s | None -> refuse "unknown symbol %s" name

(* f(c) + f'(cell) (x - c), or no value *)
let mean_value_ball balls cell t =
  let centre name = match Map_of_names.find_opt name cell with Some s -> middle_ball s | None -> raise No_value in
  let direction name = let x = find balls name in { v = x; d = less x (centre name) } in
  let whole = slope direction t in
  plus (ball Whole centre t) whole.d

(* Halves the sides of a box until [settled] holds on every cell. [names] are the sides in the order in which equals are halved. *)
let bisect ~cells ~names ~settled box =
  let left = ref cells in
  let rec go cell =
    if !left <= 0 then refuse "not shown within the cells allowed";
    decr left;
    if not (settled cell) then begin
      let wider best name =
        match best with Some b when (find cell b).level <= (find cell name).level -> best | _ -> Some name
      in
      match List.fold_left wider None names with
      | None -> refuse "not shown"
      | Some name ->
          let s = find cell name in
          let half start = Map_of_names.add name { s with start; level = s.level + 1 } cell in
          go (half (Z.shift_left s.start 1));
          go (half (Z.succ (Z.shift_left s.start 1)))
    end
  in
  go box

let most_cells bits = min 20000 (40_000_000 / bits)
let cells_allowed n = (4 * n) + 200
